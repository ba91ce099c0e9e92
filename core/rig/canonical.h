// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "relume/rig.h"

namespace relume::rigfile {

/// The value in the one form that its row's type is kept in (relume::Value), checked. `what` names the owner in
/// messages. Throws Problem(type, range, or name for a choice).
Value canonical(const Parameter& row, const Value& value, std::string_view what);

/// The same for each of the keys. Rows that hold no number, colour or vector take none.
Value canonical_keys(const Parameter& row, const Keys& keys, std::string_view what);

}  // namespace relume::rigfile
