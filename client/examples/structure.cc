// Streams into a structure of one's own, a height for each column, and stops when it has seen enough.
// Usage: structure ADDRESS MESH.drc RESOLUTION [MOST_VOXELS]
#include <algorithm>
#include <bit>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <utility>

#include "client/client.h"

int main(int argc, char** argv) {
  namespace lv = latvox::client;
  if (argc != 4 && argc != 5) return std::fputs("structure ADDRESS MESH.drc RESOLUTION [MOST_VOXELS]\n", stderr), 2;
  std::ifstream file(argv[2], std::ios::binary);
  const std::string mesh{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const uint64_t most = argc == 5 ? std::strtoull(argv[4], nullptr, 10) : UINT64_MAX;
  auto client = lv::Client::Connect(argv[1]);
  if (!client.ok()) return std::fprintf(stderr, "%s\n", client.status().ToString().c_str()), 1;

  std::map<std::pair<int32_t, int32_t>, int32_t> heights;  // of the columns (i, j): the highest k
  uint64_t voxels = 0;
  const auto take = [&](const lv::BrickBatch& batch) {
    for (const lv::Brick& brick : batch.bricks) {
      const auto& [bi, bj, bk] = brick.brick_ijk;
      for (int32_t x = 0; x < 8; ++x) {
        for (uint64_t word = brick.mask[static_cast<size_t>(x)]; word != 0; word &= word - 1) {
          const int bit = std::countr_zero(word);  // y<<3 | z
          const int32_t k = 8 * bk + (bit & 7);
          const auto column = heights.try_emplace({8 * bi + x, 8 * bj + (bit >> 3)}, k).first;
          column->second = std::max(column->second, k);
          ++voxels;
        }
      }
    }
    return voxels > most ? absl::CancelledError("enough") : absl::OkStatus();
  };
  lv::VoxelizeRequest request;
  request.resolution = static_cast<uint32_t>(std::atoi(argv[3]));
  const auto summary = client->Voxelize(request, mesh, {.on_bricks = take});
  if (!summary.ok()) return std::fprintf(stderr, "%s\n", summary.status().ToString().c_str()), 1;
  std::printf("%llu voxels over %zu columns\n", static_cast<unsigned long long>(voxels), heights.size());
}
