# SPDX-License-Identifier: Apache-2.0
# Writes the page with its code as a C++ array of bytes: OUT, of the folder DIR.
file(READ ${DIR}/page.html page)
file(READ ${DIR}/page.js code)
file(READ ${DIR}/picture.js picture)
string(REPLACE "@CODE@" "${code}${picture}start();\n" page "${page}")
file(WRITE ${OUT}.html "${page}")
file(READ ${OUT}.html bytes HEX)
string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
file(WRITE ${OUT} "#include <cstddef>\nextern const unsigned char gcdt_view_page[];\nextern const std::size_t gcdt_view_page_size;
const unsigned char gcdt_view_page[] = {${bytes}};\nconst std::size_t gcdt_view_page_size = sizeof gcdt_view_page;\n")
