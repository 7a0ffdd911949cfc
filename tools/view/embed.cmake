# SPDX-License-Identifier: Apache-2.0
# Writes the page as a C++ array of bytes: OUT from PAGE.
file(READ ${PAGE} bytes HEX)
string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
file(WRITE ${OUT} "#include <cstddef>\nextern const unsigned char gcdt_view_page[];\nextern const std::size_t gcdt_view_page_size;
const unsigned char gcdt_view_page[] = {${bytes}};\nconst std::size_t gcdt_view_page_size = sizeof gcdt_view_page;\n")
