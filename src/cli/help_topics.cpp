// The topics of `gltf-nmc help`; the man page has them too. At most 80 columns.
#include "cli/reference.h"

namespace nmc::cli {

const std::vector<Topic>& help_topics() {
  static const std::vector<Topic> topics{
      {"tolerance", "How much error may be seen, and how it is measured",
       R"(--tolerance says how far any point of the character may be from where it should
be, in world space: at all key times, at the midpoints between them, at joints
and at the outermost vertices of the skin that each joint moves.

    --tolerance 0.1%    of the character's size (the default)
    --tolerance 2mm     a length; 1cm and 0.01m as well, a glTF unit is a metre

The size is the largest side of the box around the character's joints at rest.
0.1% is 1.8 mm on a person, which nobody sees; 0.5% is right for most games; 2%
is for crowds and things far away.

The error is measured on the bytes that are written, decoded again. An animation
that would miss the tolerance, or become larger, stays as it was, and the table
says so. gltf-nmc verify ORIGINAL FILE measures it once more.
)"},
      {"pipeline", "Many files, the cache, dry runs, several machines",
       R"(Several inputs go into a folder, each under its own name:

    gltf-nmc assets/*.glb -o out/ --cache ~/.cache/gltf-nmc

The folder is made where it is missing. A file that fails does not stop the
others; the exit code is the highest of all. Two inputs of the same name are
refused. --dry-run reads and checks the inputs, says what would be done, and
writes nothing. --json prints one document about all files.

With --cache a result is found again by what it was made from: the bytes of the
input and of its buffers, the options, and this very gltf-nmc. Several runs and
machines may share a cache. An entry that is damaged is noticed and made again.

An output is replaced only when it is complete, so any tool that runs commands
can run gltf-nmc, stop it and run it again:

    parallel --joblog log --resume-failed gltf-nmc {} -o out/ ::: assets/*.glb

docs/pipeline.md and samples/pipeline have working examples with GNU parallel,
on one machine and several, and with CMake and Ninja.
)"},
      {"exit-codes", "What the exit code says",
       R"(    0  done
    1  the command line makes no sense
    2  a file cannot be read or written
    3  the input breaks its format
    4  the input needs something that is not supported
    5  the tolerance is not kept (verify)
    6  a defect in gltf-nmc, or not enough memory

A failure is one sentence on standard error that starts with "gltf-nmc: ". With
several inputs there is one for each that failed, and the exit code is the
highest. An animation that stays as it was is no failure.
)"},
      {"formats", "What is read and written",
       R"(.glb and .gltf (glTF 2.0) are read and written; the name of the output says
which. A .gltf output gets its buffers as .bin files beside it, and keeps the
images it refers to (they are copied when the folder is another one). Meshes
compressed by Draco, meshopt and quantisation are read and stay as they are.

Compressed animations are in the extension NMC_animation_compression, which a
player needs a decoder for. With --optional players without it show the model,
standing still; with --fallback the original keys stay in the file as well.
gltf-nmc decode turns a compressed file back into plain glTF.

gltf-nmc import reads motion capture: .bvh.
)"},
      {"terminal", "Progress, colours, what goes where",
       R"(Tables and JSON go to standard output; failures and progress to standard error.

Where standard error is a terminal, long work shows one line with the share
done, the time left and the animation that was finished last. In a pipe or a
file nothing of this is written; -v writes a plain line for each animation
there. -q writes neither progress nor table.

Colours are used on terminals only, and not where NO_COLOR is set or TERM is
dumb. Tables fit 100 columns.
)"},
  };
  return topics;
}

}  // namespace nmc::cli
