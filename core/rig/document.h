// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "relume/rig.h"

namespace relume::rigfile {

struct Place {
    std::uint32_t line = 0;
    std::uint32_t column = 0;
};

struct Entry;

/// A TOML value, with where it stands; keys are in the order of the file.
struct Node {
    struct Table {
        std::vector<Entry> entries;
        const Entry* find(std::string_view key) const;
    };
    using Tables = std::vector<Node>;
    /// What no key of a rig takes; `what` says what it is, for messages: "a date".
    struct Other {
        std::string what;
    };

    Place at;
    std::variant<Value, Table, Tables, Other> data;

    const Table* table() const { return std::get_if<Table>(&data); }
    /// "a table", "the string 'bright'", …
    std::string describe() const;
};

struct Entry {
    std::string key;
    Place at;  ///< of the key
    Node node;
};

/// A text with the name that messages call it by.
struct Source {
    std::string name;
    std::string text;
    std::string place(Place at) const;  ///< "key.relume:12:1"
};

/// Throws Error(rig) with the place for what is not TOML or not UTF-8.
Node::Table parse(const Source& source);

/// A value as on the command line: TOML, or a bare word. Tables come as Node::Table. Throws Problem(type) when it
/// starts like TOML's strings, lists or tables and is none. `key`: what it is the value of, for messages.
Node parse_value(std::string_view text, std::string_view key);

}  // namespace relume::rigfile
