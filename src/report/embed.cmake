# cmake -DOUT=FILE.cpp -DNAMES=a|b -DFILES=x|y -P embed.cmake: text files as a C++ source that defines nmc::report::embedded_text.
string(REPLACE "|" ";" names "${NAMES}")
string(REPLACE "|" ";" files "${FILES}")
set(arrays "")
set(cases "")
set(number 0)
foreach(name file IN ZIP_LISTS names files)
  file(READ "${file}" hex HEX)
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${hex}")
  string(APPEND arrays "constexpr unsigned char text${number}[] = {${bytes}0};\n")
  string(APPEND cases "  if (name == \"${name}\") return view(text${number}, sizeof text${number} - 1);\n")
  math(EXPR number "${number} + 1")
endforeach()
file(WRITE "${OUT}"
"#include \"report/embedded_text.h\"\n#include <stdexcept>\nnamespace nmc::report {\nnamespace {\n${arrays}
std::string_view view(const unsigned char* bytes, std::size_t size) { return {reinterpret_cast<const char*>(bytes), size}; }
}
std::string_view embedded_text(std::string_view name) {\n${cases}  throw std::logic_error(\"no such text\");\n}\n}\n")
