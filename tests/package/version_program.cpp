// SPDX-License-Identifier: Apache-2.0
// Links the installed library, calls into it, and catches its exception across the library's border.
#include <relume/error.h>
#include <relume/version.h>

#include <iostream>

int main() {
    std::cout << "relume " << relume::version() << ", " << relume::openexr_build() << '\n';
    return relume::version() == "0.1.0" ? 0 : 1;
}
