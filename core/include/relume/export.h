// SPDX-License-Identifier: Apache-2.0
#pragma once

// Everything in librelume is compiled with hidden visibility; RELUME_API marks what users of the shared library see.
#if defined(_WIN32)
#  define RELUME_API
#else
#  define RELUME_API __attribute__((visibility("default")))
#endif
