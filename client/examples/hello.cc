// The shortest way from a mesh to voxels; with TLS and a token if files are named.
// Usage: hello ADDRESS[,ADDRESS...] MESH.drc RESOLUTION [CA.pem TOKEN_FILE]
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include "client/client.h"
#include "client/error.h"

namespace {

namespace lv = latvox::client;

std::string Read(const char* path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

int Fail(const absl::Status& status) {
  std::fprintf(stderr, "%s\n", status.ToString().c_str());
  if (const lv::ErrorDetails details = lv::GetErrorDetails(status); !details.field.empty()) {
    std::fprintf(stderr, "field %s, limit %s\n", details.field.c_str(), details.limit.c_str());
  }
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4 && argc != 6) return std::fputs("hello ADDRESS MESH.drc RESOLUTION [CA.pem TOKEN_FILE]\n", stderr), 2;
  lv::ConnectionOptions connection;
  if (argc == 6) {
    connection.credentials.tls_ca_file = argv[4];
    connection.credentials.token = Read(argv[5]);
    while (connection.credentials.token.ends_with('\n')) connection.credentials.token.pop_back();
  }
  // Several servers, with commas: a stream that breaks goes on at another, and the handlers below do not notice.
  auto client = lv::Client::Connect(argv[1], {}, connection);
  if (!client.ok()) return Fail(client.status());

  lv::VoxelizeRequest request;
  request.lattice = lv::NamedLattice::kBcc;
  request.resolution = static_cast<uint32_t>(std::atoi(argv[3]));
  uint64_t bricks = 0;
  const auto summary = client->Voxelize(request, Read(argv[2]), {.on_bricks = [&](const lv::BrickBatch& batch) {
                                          bricks += batch.bricks.size();
                                          return absl::OkStatus();
                                        }});
  if (!summary.ok()) return Fail(summary.status());
  std::printf("%llu voxels in %llu bricks, digest %s\n", static_cast<unsigned long long>(summary->voxels),
              static_cast<unsigned long long>(bricks), summary->certificate.digest.c_str());
}
