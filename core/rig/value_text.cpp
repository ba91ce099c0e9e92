// SPDX-License-Identifier: Apache-2.0
#include "rig/value_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "rig/problem.h"

namespace relume::rigfile {

namespace {

template <class... F> struct Overload : F... { using F::operator()...; };
template <class... F> Overload(F...) -> Overload<F...>;

template <class List, class Text> std::string list_text(const List& list, Text text) {
    std::string out = "[";
    for (const auto& item : list) out += (out.size() == 1 ? "" : ", ") + text(item);
    return out + "]";
}

/// Rows of numbers, each in the fewest digits that read back to the same float.
std::string table_text(const LookupTable& table) {
    std::string out = "[";
    for (std::size_t i = 0; i < table.texels.size(); ++i) {
        const bool row = i % static_cast<std::size_t>(table.width) == 0;
        out += row ? (i == 0 ? "[" : "], [") : ", ";
        char buffer[32];
        out.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, table.texels[i]).ptr);
    }
    return out + "]]";
}

constexpr std::string_view kInterpolations[] = {"linear", "hold", "smooth"};

std::string keys_text(const Keys& keys) {
    std::string out = "{ keys = [";
    for (std::size_t k = 0; k < keys.frames.size(); ++k) {
        out += (k == 0 ? "[" : ", [") + short_number_text(keys.frames[k]);
        for (int c = 0; c < keys.components; ++c)
            out += ", " + short_number_text(keys.values[k][static_cast<std::size_t>(c)]);
        out += "]";
    }
    out += "]";
    if (keys.interpolation != Keys::Interpolation::linear)
        out += ", interpolation = " + string_text(kInterpolations[static_cast<std::size_t>(keys.interpolation)]);
    return out + " }";
}

std::string plural(std::size_t count, std::string_view thing) {
    return std::to_string(count) + " " + std::string(thing) + (count == 1 ? "" : "s");
}

}  // namespace

std::string number_text(double number) {
    if (std::isnan(number)) return "nan";
    if (std::isinf(number)) return number > 0 ? "inf" : "-inf";
    char buffer[32];
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, number).ptr;
    std::string text(buffer, end);
    // TOML's floats have a point or an exponent; without, it is an integer.
    if (text.find_first_of(".e") == std::string::npos) text += ".0";
    return text;
}

std::string short_number_text(double number) {
    std::string text = number_text(number);
    // −0 stays a float: as an integer it would lose its sign.
    if (text.ends_with(".0") && text != "-0.0") text.resize(text.size() - 2);
    return text;
}

std::string string_text(std::string_view text) {
    constexpr char kDigits[] = "0123456789ABCDEF";
    std::string out = "\"";
    for (const char c : text) {
        const auto u = static_cast<unsigned char>(c);
        switch (c) {
            case '"':
                out += "\\\"";
                break;
            case '\\':
                out += "\\\\";
                break;
            case '\n':
                out += "\\n";
                break;
            case '\t':
                out += "\\t";
                break;
            case '\r':
                out += "\\r";
                break;
            default:
                if (u < 0x20 || u == 0x7F) (out += "\\u00") += {kDigits[u >> 4], kDigits[u & 15]};
                else out += c;
        }
    }
    return out + "\"";
}

std::string key_text(std::string_view key) {
    const bool bare = !key.empty() && std::all_of(key.begin(), key.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
    });
    return bare ? std::string(key) : string_text(key);
}

std::string value_text(const Value& value, ParameterType type) {
    return std::visit(Overload{
                          [](bool v) -> std::string { return v ? "true" : "false"; },
                          [](std::int64_t v) { return std::to_string(v); },
                          [](double v) { return number_text(v); },
                          [type](const std::array<double, 3>& v) {
                              const bool grey = type == ParameterType::color && v[0] == v[1] && v[1] == v[2];
                              return grey ? number_text(v[0]) : list_text(v, short_number_text);
                          },
                          [](const std::string& v) { return string_text(v); },
                          [](const std::vector<std::string>& v) { return list_text(v, string_text); },
                          [](const std::vector<double>& v) { return list_text(v, short_number_text); },
                          [](const ChannelRef& v) {
                              return "{ channel = " + string_text(v.channel) + ", scale = " + number_text(v.scale) +
                                     ", offset = " + number_text(v.offset) + " }";
                          },
                          [](const LookupTable& v) { return table_text(v); },
                          [](const Keys& v) { return keys_text(v); },
                      },
                      value);
}

std::string describe(const Value& value) {
    return std::visit(Overload{
                          [](bool v) -> std::string { return v ? "true" : "false"; },
                          [](std::int64_t v) { return "the number " + std::to_string(v); },
                          [](double v) { return "the number " + short_number_text(v); },
                          [](const std::array<double, 3>&) -> std::string { return "a list of 3 numbers"; },
                          [](const std::string& v) { return "the string " + in_quotes(v); },
                          [](const std::vector<std::string>& v) { return "a list of " + plural(v.size(), "string"); },
                          [](const std::vector<double>& v) {
                              return v.empty() ? std::string("an empty list")
                                               : "a list of " + plural(v.size(), "number");
                          },
                          [](const ChannelRef& v) { return "the channel " + in_quotes(v.channel); },
                          [](const LookupTable&) -> std::string { return "a list of lists"; },
                          [](const Keys&) -> std::string { return "keys over frames"; },
                      },
                      value);
}

std::string expectation(const Parameter& row) {
    switch (row.type) {
        case ParameterType::scalar:
            return "a number";
        case ParameterType::color:
            return "a number or 3 numbers [r, g, b]";
        case ParameterType::vector:
            return "3 numbers [x, y, z]";
        case ParameterType::boolean:
            return "true or false";
        case ParameterType::integer:
            return "a whole number";
        case ParameterType::choice: {
            std::string list;
            for (const std::string_view choice : split_choices(row.choices))
                list += (list.empty() ? "" : ", ") + string_text(choice);
            return "one of " + list;
        }
        case ParameterType::text:
            return "a string";
        case ParameterType::text_list:
            return "a list of strings";
        case ParameterType::number_list:
            return row.count > 0 ? "a list of " + plural(static_cast<std::size_t>(row.count), "number")
                                 : "a list of numbers";
        case ParameterType::table:
            return "the name of a file, or rows of numbers [[…], […]]";
    }
    return {};
}

std::vector<std::string_view> split_choices(std::string_view choices) {
    std::vector<std::string_view> out;
    while (!choices.empty()) {
        const std::size_t bar = choices.find('|');
        out.push_back(choices.substr(0, bar));
        choices = bar == std::string_view::npos ? std::string_view{} : choices.substr(bar + 1);
    }
    return out;
}

}  // namespace relume::rigfile
