// SPDX-License-Identifier: Apache-2.0
#include "rig/document.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "rig/problem.h"
#include "rig/tomlplusplus.h"
#include "rig/value_text.h"
#include "text/printable.h"

namespace relume::rigfile {

namespace {

// A rig nests four deep. What is deeper is never looked at; reading it would cost stack.
constexpr int kDeepest = 8;
// toml++ recurses over every dot of a key when it frees the tables: a million of them would overflow the stack.
constexpr int kMostDots = 16;

Place place_of(const toml::source_region& region) { return {region.begin.line, region.begin.column}; }

Node convert(const toml::node& node, int depth);

Node::Table convert_table(const toml::table& table, int depth) {
    Node::Table out;
    for (const auto& [key, value] : table)
        out.entries.push_back({std::string(key.str()), place_of(key.source()), convert(value, depth + 1)});
    // toml++ sorts by name; the first mistake of a file is to be the one that is told.
    std::stable_sort(out.entries.begin(), out.entries.end(), [](const Entry& a, const Entry& b) {
        return a.at.line != b.at.line ? a.at.line < b.at.line : a.at.column < b.at.column;
    });
    return out;
}

template <class T, class Out = T> std::optional<std::vector<Out>> list_of(const toml::array& array) {
    std::vector<Out> out;
    for (const toml::node& item : array) {
        if (const auto value = item.value_exact<T>()) out.push_back(Out(*value));
        else return std::nullopt;
    }
    return out;
}

std::optional<std::vector<double>> numbers_of(const toml::array& array) {
    std::vector<double> out;
    for (const toml::node& item : array) {
        const auto value = item.is_number() ? item.value<double>() : std::nullopt;
        if (!value) return std::nullopt;
        out.push_back(*value);
    }
    return out;
}

/// Rows of numbers, all of one length.
std::optional<LookupTable> table_of(const toml::array& array) {
    LookupTable out;
    for (const toml::node& item : array) {
        const auto numbers = item.is_array() ? numbers_of(*item.as_array()) : std::nullopt;
        if (!numbers || numbers->empty() || (out.height > 0 && std::ssize(*numbers) != out.width)) return std::nullopt;
        out.width = static_cast<int>(numbers->size());
        ++out.height;
        for (const double number : *numbers) out.texels.push_back(static_cast<float>(number));
    }
    return out.height > 0 ? std::optional(std::move(out)) : std::nullopt;
}

std::variant<Value, Node::Table, Node::Tables, Node::Other> convert_array(const toml::array& array, int depth) {
    if (auto numbers = numbers_of(array)) return Value(std::move(*numbers));
    if (auto texts = list_of<std::string>(array)) return Value(std::move(*texts));
    if (auto table = table_of(array)) return Value(std::move(*table));
    if (!array.is_homogeneous(toml::node_type::table)) {
        const bool nested = std::any_of(array.begin(), array.end(), [](const toml::node& n) { return n.is_array(); });
        return Node::Other{nested ? "a list of lists" : "a list of mixed values"};
    }
    Node::Tables tables;
    for (const toml::node& item : array) tables.push_back(convert(item, depth + 1));
    return tables;
}

/// { keys = [[frame, value], …], interpolation = "…" }; a value is a number, or three numbers, in a list or not.
std::variant<Value, Node::Table, Node::Tables, Node::Other> convert_keys(const toml::table& table) {
    const Node::Other wrong{"keys of this form; write { keys = [[frame, value], …], interpolation = \"linear\" }"};
    Keys out;
    for (const auto& [name, value] : table) {
        if (name.str() == "keys") continue;
        const auto word = name.str() == "interpolation" ? value.value_exact<std::string>() : std::nullopt;
        if (word == "linear") out.interpolation = Keys::Interpolation::linear;
        else if (word == "hold") out.interpolation = Keys::Interpolation::hold;
        else if (word == "smooth") out.interpolation = Keys::Interpolation::smooth;
        else
            return Node::Other{"keys with another " + in_quotes(std::string(name.str())) +
                               "; interpolation is \"linear\", \"hold\" or \"smooth\""};
    }
    for (const toml::node& item : *table["keys"].as_array()) {
        const toml::array* row = item.as_array();
        if (row == nullptr || row->empty()) return wrong;
        std::optional<std::vector<double>> numbers;
        if (row->size() == 2 && (*row)[1].is_array()) {
            numbers = numbers_of(*(*row)[1].as_array());
            const auto frame = (*row)[0].is_number() ? (*row)[0].value<double>() : std::nullopt;
            if (!numbers || numbers->size() != 3 || !frame) return wrong;
            numbers->insert(numbers->begin(), *frame);
        } else {
            numbers = numbers_of(*row);
        }
        if (!numbers || (numbers->size() != 2 && numbers->size() != 4)) return wrong;
        const int components = numbers->size() == 2 ? 1 : 3;
        const double frame = numbers->front();
        if (!std::isfinite(frame) || (!out.frames.empty() && frame <= out.frames.back()))
            return Node::Other{"keys whose frames do not rise"};
        if (!out.frames.empty() && components != out.components) return Node::Other{"keys of mixed values"};
        out.components = components;
        out.frames.push_back(frame);
        out.values.push_back(components == 1 ? std::array<double, 3>{(*numbers)[1], 0, 0}
                                             : std::array<double, 3>{(*numbers)[1], (*numbers)[2], (*numbers)[3]});
    }
    if (out.frames.empty()) return Node::Other{"keys without any frame"};
    return Value(std::move(out));
}

Node convert(const toml::node& node, int depth) {
    Node out{place_of(node.source()), Node::Other{"a value that lies too deep"}};
    if (depth > kDeepest) return out;
    if (const auto* table = node.as_table()) {
        if (table->is_inline() && (*table)["keys"].is_array()) out.data = convert_keys(*table);
        else out.data = convert_table(*table, depth);
        return out;
    }
    if (const auto* array = node.as_array()) out.data = convert_array(*array, depth);
    else if (const auto* text = node.as_string()) out.data = Value(text->get());
    else if (const auto* integer = node.as_integer()) out.data = Value(integer->get());
    else if (const auto* number = node.as_floating_point()) out.data = Value(number->get());
    else if (const auto* boolean = node.as_boolean()) out.data = Value(boolean->get());
    else out.data = Node::Other{node.is_time() ? "a time" : "a date"};
    return out;
}

/// Steps through the text outside strings and comments, to find keys of too many parts before toml++ does.
class DotScan {
public:
    explicit DotScan(std::string_view text) : text_(text) {}

    std::optional<Place> too_deep() {
        int dots = 0;
        while (at_ < text_.size()) {
            const char c = text_[at_];
            if (c == '"' || c == '\'') {
                skip_string(c);
                continue;
            }
            if (c == '#') {
                at_ = std::min(text_.find('\n', at_), text_.size());
                continue;
            }
            if (c == '.' && ++dots > kMostDots) return place();
            if (c == '\n' || c == '=' || c == ',' || c == '[' || c == ']' || c == '{' || c == '}') dots = 0;
            ++at_;
        }
        return std::nullopt;
    }

private:
    void skip_string(char quote) {
        const std::string_view rest = text_.substr(at_);
        const bool many_lines = rest.size() >= 3 && rest[1] == quote && rest[2] == quote;
        at_ += many_lines ? 3 : 1;
        while (at_ < text_.size()) {
            if (text_[at_] == '\\' && quote == '"') {
                at_ = std::min(at_ + 2, text_.size());
            } else if (text_[at_] == quote && (!many_lines || text_.substr(at_, 3) == std::string(3, quote))) {
                at_ += many_lines ? 3 : 1;
                // Up to two quotes may stand at the end of a string of many lines.
                for (int k = 0; many_lines && k < 2 && at_ < text_.size() && text_[at_] == quote; ++k) ++at_;
                return;
            } else if (text_[at_] == '\n' && !many_lines) {
                return;
            } else {
                ++at_;
            }
        }
    }

    Place place() const {
        const std::string_view before = text_.substr(0, at_);
        const auto line = static_cast<std::uint32_t>(std::count(before.begin(), before.end(), '\n'));
        const std::size_t start = before.rfind('\n');
        return {line + 1, static_cast<std::uint32_t>(at_ - (start == std::string_view::npos ? 0 : start + 1)) + 1};
    }

    std::string_view text_;
    std::size_t at_ = 0;
};

/// What toml++ says of the text; a broken assumption of it is an error of the text.
std::optional<toml::table> parsed(std::string_view text, std::string_view name) {
    try {
        return toml::parse(text, name);
    } catch (const std::logic_error&) {
        return std::nullopt;
    }
}

/// The line up to which the text has to be read for parsed() to have no answer.
std::uint32_t broken_line(std::string_view text) {
    std::vector<std::size_t> ends;
    for (std::size_t at = 0; (at = text.find('\n', at)) != std::string_view::npos;) ends.push_back(++at);
    ends.push_back(text.size());
    const auto broken = [&](std::size_t end) {
        try {
            return !parsed(text.substr(0, end), {});
        } catch (const toml::parse_error&) {
            return false;  // a string or list that goes on in the next line
        }
    };
    const auto first = std::partition_point(ends.begin(), ends.end(), [&](std::size_t end) { return !broken(end); });
    return static_cast<std::uint32_t>(first - ends.begin()) + 1;
}

std::string_view trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(" \t\r\n");
    const auto last = text.find_last_not_of(" \t\r\n");
    return first == std::string_view::npos ? std::string_view{} : text.substr(first, last - first + 1);
}

std::string_view line_of(std::string_view text, std::uint32_t line) {
    for (; line > 1; --line) text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
    return trimmed(text.substr(0, text.find('\n')));
}

bool is_word(std::string_view text) {
    const auto in_word = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
    };
    return !text.empty() && !(text[0] >= '0' && text[0] <= '9') && text[0] != '-' &&
           std::all_of(text.begin(), text.end(), in_word);
}

/// The line of a syntax error, and what is often meant by it.
std::string shown_line(std::string_view line) {
    const std::size_t equals = line.find('=');
    const std::string_view value = equals == std::string_view::npos
                                       ? std::string_view{}
                                       : trimmed(line.substr(equals + 1, line.find('#') - equals - 1));
    std::string hint;
    if (value == "True" || value == "False" || value == "yes" || value == "no" || value == "on" || value == "off")
        hint = "; write true or false";
    else if (value != "true" && value != "false" && value.size() <= kLongestHint && is_word(value))
        hint = "; a string stands in quotes: " + string_text(value);
    return line.empty() ? hint : ", in " + in_quotes(line) + hint;
}

/// toml++'s words without what names toml++ itself.
std::string plain(std::string_view description) {
    std::string text(description.substr(0, description.find(" (TOML_MAX")));
    constexpr std::string_view kStart = "Error while ";
    if (text.starts_with(kStart)) text.erase(0, kStart.size());
    if (text.empty()) return text;
    if (text[0] >= 'A' && text[0] <= 'Z') text[0] = static_cast<char>(text[0] + 32);
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20) c = ' ';
    return text;
}

}  // namespace

const Entry* Node::Table::find(std::string_view key) const {
    const auto found = std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.key == key; });
    return found == entries.end() ? nullptr : &*found;
}

std::string Node::describe() const {
    if (const auto* value = std::get_if<Value>(&data)) return rigfile::describe(*value);
    if (const auto* other = std::get_if<Other>(&data)) return other->what;
    return std::holds_alternative<Table>(data) ? "a table" : "a list of tables";
}

std::string Source::place(Place at) const {
    return name + ":" + std::to_string(at.line) + ":" + std::to_string(at.column);
}

Node::Table parse(const Source& source) {
    if (source.text.starts_with("\xFF\xFE") || source.text.starts_with("\xFE\xFF"))
        throw Error(ErrorKind::rig, source.name + " is UTF-16 text; a rig is UTF-8: save it again as that");
    if (const auto deep = DotScan(source.text).too_deep())
        throw Error(ErrorKind::rig,
                    "a key of more than " + std::to_string(kMostDots) + " parts at " + source.place(*deep));
    try {
        if (const auto table = parsed(source.text, source.name)) return convert_table(*table, 0);
        throw Error(ErrorKind::rig, "not valid TOML at " + source.place({broken_line(source.text), 1}));
    } catch (const toml::parse_error& error) {
        throw Error(ErrorKind::rig, "not valid TOML at " + source.place(place_of(error.source())) + ": " +
                                        plain(error.description()) +
                                        shown_line(line_of(source.text, error.source().begin.line)));
    }
}

Node parse_value(std::string_view text, std::string_view key) {
    if (!is_utf8(text))
        throw Problem(Problem::Cause::type, "the value of " + in_quotes(key) + " is not UTF-8",
                      "; a rig holds nothing else");
    const std::string word(trimmed(text));
    const Node bare{{}, Value(word)};
    // One value on one line; a second line could bring keys of its own.
    const bool one_line = word.find('\n') == std::string::npos;
    const bool toml_alone = !word.empty() && (word[0] == '[' || word[0] == '{' || word[0] == '"' || word[0] == '\'');
    const auto refuse = [&](const std::string& why) -> Node {
        if (!toml_alone) return bare;
        throw Problem(Problem::Cause::type, "the value " + in_quotes(word) + " is not valid TOML", why);
    };
    if (word.empty() || !one_line) return refuse("; it must stand on one line");
    const std::string document = "value = " + word;
    if (DotScan(document).too_deep()) return refuse("; a key in it has too many parts");
    try {
        const auto table = parsed(document, {});
        if (!table) return refuse({});
        const toml::node* node = table->get("value");
        return node == nullptr || table->size() != 1 ? bare : convert(*node, 1);
    } catch (const toml::parse_error& error) {
        return refuse(": " + plain(error.description()));
    }
}

}  // namespace relume::rigfile
