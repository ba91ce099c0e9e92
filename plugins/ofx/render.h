// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host.h"

namespace relume::ofx {

OfxStatus render(OfxImageEffectHandle effect, const Properties& in);
OfxStatus region_of_definition(OfxImageEffectHandle effect, const Properties& in, const Properties& out);
OfxStatus regions_of_interest(OfxImageEffectHandle effect, const Properties& in, const Properties& out);
OfxStatus clip_preferences(OfxImageEffectHandle effect, const Properties& out);

}  // namespace relume::ofx
