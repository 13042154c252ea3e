// Prints docs/compatibility.md. With a folder as argument it also writes the files of the table's rows there.
#include <cstdio>
#include <string>

#include "corpus/compatibility.h"

int main(int argc, char** argv) {
  if (argc > 1) {
    int number = 0;
    for (const nmc::test::Feature& feature : nmc::test::features())
      nmc::test::write_bytes(std::string(argv[1]) + "/" + std::to_string(number++) + ".glb", feature.make());
  }
  std::fputs(nmc::test::compatibility_page().c_str(), stdout);
  return 0;
}
