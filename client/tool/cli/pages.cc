#include "client/tool/cli/pages.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "deploy/manual/man_page.h"
#include "deploy/manual/markdown.h"

namespace latvox::client {
namespace {

constexpr char kExitStatus[] =
    "0 done; 1 other error; 2 wrong usage; 3 bad input; 4 server not reached;\n"
    "5 refused, or no memory; 6 cancelled or timed out";

// Examples of each command. The tests run them in this order in a directory with bunny.obj.
constexpr std::pair<const char*, const char*> kExamples[] = {
    {"voxelize",
     "Examples:\n"
     "  latvox voxelize bunny.obj --lattice bcc --resolution 128 -o bunny.vdb -o bunny.png\n"
     "  latvox voxelize bunny.obj --voxel-size 0.05 --origin 0,0,0 -o bunny.csv --verify\n"
     "  latvox voxelize - --up-axis y --scale 10 --resolution 64 --weld-report -o bunny.glb < bunny.obj\n"},
    {"batch",
     "Examples:\n"
     "  echo '{\"mesh\": \"bunny.obj\", \"lattice\": \"fcc\", \"resolution\": 64}' > jobs.jsonl\n"
     "  latvox batch jobs.jsonl --out voxels --resume\n"},
    {"pixelize",
     "Examples:\n"
     "  echo '0,0 4,9 8,0 -1,6 9,6 z' > star.txt\n"
     "  latvox pixelize star.txt --lattice hexagonal --resolution 40 -o star.csv -o star.png\n"},
    {"encode",
     "Examples:\n"
     "  latvox encode bunny.obj -o bunny.drc\n"},
    {"merge",
     "Examples:\n"
     "  for i in 0 1; do latvox voxelize bunny.obj --resolution 64 --shard $i/2 -o part$i.vdb; done\n"
     "  latvox merge part0.vdb part1.vdb -o whole.vdb\n"},
    {"render",
     "Examples:\n"
     "  latvox render bunny.vdb --view -60,10 -o side.png\n"},
    {"slice",
     "Examples:\n"
     "  latvox slice bunny.vdb --axis z --index 40 -o slice.png\n"
     "  latvox voxelize bunny.obj --resolution 40 --band 3v --signed -o band.vdb\n"
     "  latvox slice band.vdb --axis z --index 10 -o distance.png -o distance.csv\n"},
    {"view",
     "Examples:\n"
     "  latvox view bunny.vdb -o bunny.html\n"},
    {"convert",
     "Examples:\n"
     "  latvox convert bunny.vdb -o bunny.nrrd -o bunny.vtu\n"
     "  latvox convert band.vdb --pad 2 -o band.nii.gz -o band.vti\n"
     "  latvox convert band.vdb -o band.nvdb -o band.png -o band.html\n"
     "  latvox convert band.nvdb -o again.vdb\n"},
    {"compare",
     "Exit status: 0 equal; 1 different; otherwise as for all commands\n"
     "\n"
     "Examples:\n"
     "  latvox compare bunny.vdb bunny.vdb\n"},
    {"info", "Examples:\n  latvox info bunny.vdb\n"},
    {"completions",
     "Examples:\n"
     "  source <(latvox completions bash)\n"},
    {"man", "Examples:\n  latvox man > latvox.1\n"},
};

ManPage Page() {
  ManPage page;
  page.version = LATVOX_VERSION;
  page.before = {{"DESCRIPTION", Introduction()}};
  page.after = {
      {"EXIT STATUS",
       absl::StrCat(kExitStatus, ".\nOne line on standard error names the error, its field and the limit.\n")},
      {"ENVIRONMENT",
       "If NO_COLOR is not empty, terminals get no colors. Files and pipes never get colors.\n"
       "\n"
       "A private server is the program LATVOX_LATVOXD, or else the latvoxd beside latvox. The variables of\n"
       "latvoxd(8), such as LATVOX_THREADS and LATVOX_MEMORY_BUDGET, apply to it as well. Exceptions are those of\n"
       "its configuration file, addresses, TLS and tokens. Its socket is in XDG_RUNTIME_DIR, or in /tmp if that is\n"
       "not set.\n"
       "\n"
       "JOB_COMPLETION_INDEX with LATVOX_WORKER_COUNT, or SLURM_ARRAY_TASK_ID with its companions, number the\n"
       "worker of latvox batch.\n"
       "\n"
       "Without --traceparent, TRACEPARENT and TRACESTATE are the W3C trace context of calls. Malformed values are\n"
       "not sent.\n"}};
  page.see_also = {"latvoxd(8)"};
  return page;
}

}  // namespace

std::string Introduction() {
  return "latvox turns triangle meshes into sparse voxels, exactly, on the Cartesian, BCC, FCC, hexagonal or any\n"
         "other three-dimensional lattice. It starts a private server for each call by itself.\n"
         "\n"
         "A mesh to begin with:\n"
         "  cp /usr/share/glmark2/models/bunny.obj .\n"
         "Its voxels on the body-centered lattice, 128 along its longest side, as OpenVDB grid and as picture:\n"
         "  latvox voxelize bunny.obj --lattice bcc --resolution 128 -o bunny.vdb -o bunny.png\n"
         "Facts about the grid:\n"
         "  latvox info bunny.vdb\n"
         "Cubes of a given size as a table of coordinates. --verify counts tunnels and redundant voxels:\n"
         "  latvox voxelize bunny.obj --voxel-size 0.05 -o bunny.csv --verify\n"
         "\n"
         "Meshes: .drc .obj .ply .stl .off .glb .gltf .3mf, or - for standard input. The extension of -o\n"
         "chooses the output format.\n"
         "\n"
         "All commands: latvox --help. Options of a command: latvox voxelize --help. Everything: man latvox.\n";
}

std::string Footer() {
  return absl::StrCat(
      "Options of a command: latvox COMMAND --help. Introduction: latvox without a command.\n"
      "Exit status: ",
      kExitStatus, "\n");
}

std::string FooterOf(const std::string& command) {
  for (const auto& [name, examples] : kExamples) {
    if (name == command) return examples;
  }
  return "";
}

std::string ManPageOf(CommandFacts facts) {
  facts.description = "exact sparse voxels of triangle meshes on any lattice";
  return ToMan(facts, Page());
}

std::string ReferenceOf(const CommandFacts& facts) { return ToMarkdown(facts, Page()); }

}  // namespace latvox::client
