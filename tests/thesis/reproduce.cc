// Measures everything that the page of tests/thesis/run shows.
//   thesis_reproduce [--quick] --times ROUND DIRECTORY
//   thesis_reproduce [--quick] DIRECTORY [NAME=MESH ...]
// The first writes the times of one round, timing-ROUND.csv and orientation-ROUND.csv. The second writes everything
// else: accuracy.csv, precision.csv, models.csv, tables.csv, settings.csv.
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "client/mesh_files/mesh_file.h"
#include "tests/thesis/measure.h"
#include "tests/thesis/models.h"
#include "tests/thesis/plan.h"
#include "tests/thesis/precision.h"
#include "tests/thesis/table_file.h"
#include "tests/thesis/tables.h"
#include "tests/thesis/times.h"

namespace latvox::thesis {
namespace {

struct Run {
  const LatticeCase* lattice_case;
  int32_t resolution;
  double degrees;
  Algorithm algorithm;
  std::string_view name;
  Measurement measured = {};
};

// Runs the largest cases first, so that no thread ends with a large one alone.
double MeasureAccuracy(const Plan& plan) {
  const Stopwatch watch;
  const std::vector<LatticeCase> cases = LatticeCases();
  std::vector<Run> runs;
  for (auto resolution = plan.resolutions.rbegin(); resolution != plan.resolutions.rend(); ++resolution) {
    for (const LatticeCase& lattice_case : cases) {
      for (double degrees : plan.angles) {
        for (const auto& [algorithm, name] : kAlgorithms) {
          runs.push_back({&lattice_case, *resolution, degrees, algorithm, name});
        }
      }
    }
  }
  std::atomic<size_t> next = 0;
  oneapi::tbb::parallel_for(0, oneapi::tbb::this_task_arena::max_concurrency(), [&](int) {
    for (size_t n = next++; n < runs.size(); n = next++) {
      Run& run = runs[n];
      // A run that waits inside must not begin another.
      oneapi::tbb::this_task_arena::isolate([&] {
        run.measured = Measure(MakeExperiment(*run.lattice_case, run.resolution), run.degrees, run.algorithm);
      });
      if (n % 512 == 0) std::fprintf(stderr, "accuracy: %zu of %zu, %.0f s\n", n, runs.size(), watch.Seconds());
    }
  });

  TableFile table(plan.directory + "/accuracy.csv",
                  "lattice,k,resolution,algorithm,degrees,voxels,points,displaced_volume,r,minimal,at_seam,"
                  "by_other_surface,not_minimal,tunnels,redundant,tunnels_rounded,redundant_rounded");
  for (auto run = runs.rbegin(); run != runs.rend(); ++run) {
    const Measurement& m = run->measured;
    table.Add("%s,%d,%d,%s,%.4f,%d,%d,%.9f,%.9f,%d,%d,%d,%d,%d,%d,%d,%d", run->lattice_case->name, run->lattice_case->k,
              run->resolution, run->name, run->degrees, m.voxels,
              MakeExperiment(*run->lattice_case, run->resolution).volume.points(), m.displaced, m.minimality.Ratio(),
              m.minimality.minimal, m.minimality.at_seam, m.minimality.by_other_surface, m.minimality.redundant,
              m.given.tunnels, m.given.redundant, m.rounded.tunnels, m.rounded.redundant);
  }
  table.Close();
  return watch.Seconds();
}

double MeasurePrecision(const Plan& plan) {
  const Stopwatch watch;
  TableFile table(plan.directory + "/precision.csv",
                  "lattice,k,resolution,placement,precision,planes,voxels,doubled,empty,wrong");
  for (const PrecisionRow& row : PrecisionRows(plan)) {
    const PrecisionCounts& n = row.counts;
    table.Add("%s,%d,%d,%s,%s,%d,%d,%d,%d,%d", row.lattice_case.name, row.lattice_case.k, row.resolution, row.placement,
              row.precision, n.planes, n.voxels, n.doubled, n.empty, n.wrong);
  }
  table.Close();
  return watch.Seconds();
}

TriangleMesh Read(const std::string& path) {
  const auto file = client::ReadMesh(path);
  if (!file.ok()) {
    std::fprintf(stderr, "thesis_reproduce: %s\n", file.status().ToString().c_str());
    std::exit(1);
  }
  TriangleMesh mesh{{}, file->triangles};
  for (const auto& [x, y, z] : file->positions) {
    mesh.vertices.push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)});
  }
  return mesh;
}

double MeasureModels(const Plan& plan) {
  const Stopwatch watch;
  TableFile table(plan.directory + "/models.csv",
                  "model,triangles,case,algorithm,voxels,tunnels,redundant,tunnels_rounded,redundant_rounded,seconds");
  for (const auto& [model, path] : plan.meshes) {
    const TriangleMesh mesh = Read(path);
    std::vector<ModelCase> cases = ModelCases();
    if (plan.quick) cases.erase(cases.begin() + 3, cases.end());
    for (const ModelCase& model_case : cases) {
      for (const auto& [algorithm, name] : kAlgorithms) {
        const ModelResult result = MeasureModel(mesh, model_case, algorithm);
        table.Add("%s,%d,\"%s\",%s,%d,%d,%d,%d,%d,%.3f", model, mesh.triangles.size(), model_case.Title(), name,
                  result.voxels, result.given.tunnels, result.given.redundant, result.rounded.tunnels,
                  result.rounded.redundant, result.seconds);
      }
    }
    std::fprintf(stderr, "models: %s, %.0f s\n", model.c_str(), watch.Seconds());
  }
  table.Close();
  return watch.Seconds();
}

void CheckTables(const Plan& plan) {
  TableFile table(plan.directory + "/tables.csv",
                  "table,direction,m,n,det_n,true_n,spans,is_last,n_right,our_m,our_n,our_det_n");
  for (const TableRow& row : CheckedTables()) {
    table.Add("%s,%d %d %d,%s,%s,%g,%s,%d,%d,%d,%s,%s,%g", row.table, row.direction[0], row.direction[1],
              row.direction[2], TextOf(row.m), TextOf(row.n), row.det_n, TextOf(row.true_n), row.spans, row.is_last,
              row.n_right, TextOf(row.our_m), TextOf(row.our_n), row.our_det_n);
  }
  table.Close();
}

void MeasureAll(const Plan& plan) {
  CheckTables(plan);
  const double precision = MeasurePrecision(plan), accuracy = MeasureAccuracy(plan), models = MeasureModels(plan);
  TableFile table(plan.directory + "/settings.csv", "key,value");
  table.Add("quick,%d", plan.quick);
  table.Add("angles,%d", plan.angles.size());
  table.Add("timed_angles,%d", plan.timed_angles.size());
  table.Add("angle_seed,%d", kAngleSeed);
  table.Add("threads,%d", oneapi::tbb::this_task_arena::max_concurrency());
  table.Add("seconds,%.1f", precision + accuracy + models);
  table.Close();
}

int Usage() {
  std::fprintf(stderr,
               "Usage: thesis_reproduce [--quick] --times ROUND DIRECTORY\n"
               "       thesis_reproduce [--quick] DIRECTORY [NAME=MESH ...]\n");
  return 2;
}

}  // namespace
}  // namespace latvox::thesis

int main(int argc, char** argv) {
  std::vector<std::string> arguments(argv + 1, argv + argc);
  const bool quick = !arguments.empty() && arguments[0] == "--quick";
  if (quick) arguments.erase(arguments.begin());
  latvox::thesis::Plan plan = latvox::thesis::PlanFor(quick);
  if (!arguments.empty() && arguments[0] == "--times") {
    if (arguments.size() != 3) return latvox::thesis::Usage();
    plan.directory = arguments[2];
    latvox::thesis::MeasureTimes(plan, arguments[1]);
    return 0;
  }
  if (arguments.empty()) return latvox::thesis::Usage();
  for (size_t n = 1; n < arguments.size(); ++n) {
    const size_t equals = arguments[n].find('=');
    if (equals == std::string::npos) return latvox::thesis::Usage();
    plan.meshes.emplace_back(arguments[n].substr(0, equals), arguments[n].substr(equals + 1));
  }
  plan.directory = arguments[0];
  latvox::thesis::MeasureAll(plan);
  return 0;
}
