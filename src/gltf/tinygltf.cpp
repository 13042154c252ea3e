// The one translation unit that compiles tinygltf; TINYGLTF_NO_* macros come from the build so that all units agree.
#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>
