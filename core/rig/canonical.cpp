// SPDX-License-Identifier: Apache-2.0
#include "rig/canonical.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "rig/problem.h"
#include "rig/value_text.h"

namespace relume::rigfile {

namespace {

using Triple = std::array<double, 3>;

std::optional<double> as_number(const Value& value) {
    if (const auto* d = std::get_if<double>(&value)) return *d;
    if (const auto* i = std::get_if<std::int64_t>(&value)) return static_cast<double>(*i);
    return std::nullopt;
}

std::optional<Triple> as_triple(const Value& value) {
    if (const auto* t = std::get_if<Triple>(&value)) return *t;
    const auto* list = std::get_if<std::vector<double>>(&value);
    if (list == nullptr || list->size() != 3) return std::nullopt;
    return Triple{(*list)[0], (*list)[1], (*list)[2]};
}

std::optional<std::int64_t> as_integer(const Value& value) {
    if (const auto* i = std::get_if<std::int64_t>(&value)) return *i;
    const auto* d = std::get_if<double>(&value);
    // Beyond 2^53 a double no longer tells one whole number from the next.
    if (d == nullptr || std::trunc(*d) != *d || std::abs(*d) > 0x1p53) return std::nullopt;
    return static_cast<std::int64_t>(*d);
}

std::optional<std::vector<double>> as_numbers(const Value& value) {
    if (const auto* list = std::get_if<std::vector<double>>(&value)) return *list;
    if (const auto* t = std::get_if<Triple>(&value)) return std::vector<double>(t->begin(), t->end());
    return std::nullopt;
}

std::optional<std::vector<std::string>> as_texts(const Value& value) {
    if (const auto* list = std::get_if<std::vector<std::string>>(&value)) return *list;
    if (const auto* one = std::get_if<std::string>(&value)) return std::vector<std::string>{*one};
    const auto* empty = std::get_if<std::vector<double>>(&value);
    if (empty != nullptr && empty->empty()) return std::vector<std::string>{};
    return std::nullopt;
}

bool takes_channel(const Parameter& row) { return row.slot >= 0 && row.is_number(); }

class Check {
public:
    Check(const Parameter& row, const Value& value, std::string_view what) : row_(row), value_(value), what_(what) {}
    Check(const Parameter& row, Value&& value, std::string_view what) = delete;

    std::string name() const { return what_ + ": " + std::string(row_.name); }

    [[noreturn]] void wrong_type() const {
        const auto* text = std::get_if<std::string>(&value_);
        const bool channel = text != nullptr && text->size() <= kLongestHint && takes_channel(row_);
        throw Problem(Problem::Cause::type, name() + " takes " + expectation(row_) + ", not " + describe(value_),
                      channel ? "; a channel is written { channel = " + string_text(*text) + " }" : "");
    }

    void range(double number) const {
        if (!std::isfinite(number))
            throw Problem(Problem::Cause::range, name() + " is " + short_number_text(number), "; it must be finite");
        if (number >= row_.min && number <= row_.max) return;
        const std::string low = short_number_text(row_.min), high = short_number_text(row_.max);
        const std::string allowed = std::isinf(row_.max)   ? "at least " + low
                                    : std::isinf(row_.min) ? "at most " + high
                                                           : "within " + low + " … " + high;
        throw Problem(Problem::Cause::range, name() + " is " + short_number_text(number),
                      "; it must be " + allowed + (row_.unit.empty() ? "" : " " + std::string(row_.unit)));
    }

    void table(const LookupTable& table) const {
        try {
            check_table(table, name());
        } catch (const Error& error) {
            throw Problem(Problem::Cause::range, error.what());
        }
    }

    template <class T> const T& some(const std::optional<T>& converted) const {
        if (!converted) wrong_type();
        return *converted;
    }

private:
    const Parameter& row_;
    const Value& value_;
    std::string what_;
};

std::string choice_of(const Parameter& row, const std::string& word, const Check& check) {
    const auto choices = split_choices(row.choices);
    if (std::find(choices.begin(), choices.end(), word) != choices.end()) return word;
    throw Problem(Problem::Cause::name, check.name() + " has no choice " + in_quotes(word), suggestion(word, choices));
}

}  // namespace

Value canonical_keys(const Parameter& row, const Keys& keys, std::string_view what) {
    const Value whole(keys);  // Check refers to it
    const Check check(row, whole, what);
    if (!row.is_number()) check.wrong_type();
    Keys out = keys;
    out.components = row.components();
    for (std::size_t k = 0; k < keys.frames.size(); ++k) {
        const Value one = keys.components == 1 ? Value(keys.values[k][0]) : Value(keys.values[k]);
        const Value value = canonical(row, one, std::string(what) + ", frame " + short_number_text(keys.frames[k]));
        out.values[k] = row.components() == 1 ? Triple{std::get<double>(value), 0, 0} : std::get<Triple>(value);
    }
    return out;
}

Value canonical(const Parameter& row, const Value& value, std::string_view what) {
    const Check check(row, value, what);
    if (const auto* channel = std::get_if<ChannelRef>(&value)) {
        if (!takes_channel(row)) check.wrong_type();
        if (channel->channel.empty())
            throw Problem(Problem::Cause::range, check.name() + ": the channel's name is empty");
        if (!std::isfinite(channel->scale) || !std::isfinite(channel->offset))
            throw Problem(Problem::Cause::range, check.name() + ": scale and offset must be finite");
        return value;
    }
    switch (row.type) {
        case ParameterType::scalar: {
            const double number = check.some(as_number(value));
            check.range(number);
            return number;
        }
        case ParameterType::integer: {
            const std::int64_t number = check.some(as_integer(value));
            check.range(static_cast<double>(number));
            return number;
        }
        case ParameterType::color:
        case ParameterType::vector: {
            const auto grey = row.type == ParameterType::color ? as_number(value) : std::nullopt;
            const Triple triple = grey ? Triple{*grey, *grey, *grey} : check.some(as_triple(value));
            for (const double number : triple) check.range(number);
            return triple;
        }
        case ParameterType::boolean:
            if (!std::holds_alternative<bool>(value)) check.wrong_type();
            return value;
        case ParameterType::choice:
            if (!std::holds_alternative<std::string>(value)) check.wrong_type();
            return choice_of(row, std::get<std::string>(value), check);
        case ParameterType::text:
            if (!std::holds_alternative<std::string>(value)) check.wrong_type();
            return value;
        case ParameterType::text_list:
            return check.some(as_texts(value));
        case ParameterType::number_list: {
            const auto numbers = check.some(as_numbers(value));
            if (row.count > 0 && numbers.size() != static_cast<std::size_t>(row.count)) check.wrong_type();
            for (const double number : numbers) check.range(number);
            return numbers;
        }
        case ParameterType::table:
            if (const auto* table = std::get_if<LookupTable>(&value)) check.table(*table);
            else if (!std::holds_alternative<std::string>(value)) check.wrong_type();
            return value;
    }
    check.wrong_type();
}

}  // namespace relume::rigfile
