// A server that proves its name, and requires a token and perhaps a certificate of the client.
#include <latvox/client.h>

#include "example.h"

int main(int argc, char** argv) {
  namespace lv = latvox::client;
  if (argc != 5 && argc != 7)
    return example::Usage("tls HOST:PORT MESH.drc CA.pem TOKEN_FILE [CERTIFICATE.pem KEY.pem]");
  const auto mesh = example::Read(argv[2]), token = example::Read(argv[4]);
  if (!mesh.ok()) return example::Fail(mesh.status());
  if (!token.ok()) return example::Fail(token.status());
  lv::ConnectionOptions connection;
  connection.credentials.tls_ca_file = argv[3];
  connection.credentials.token = *token;
  while (connection.credentials.token.ends_with('\n')) connection.credentials.token.pop_back();
  if (argc == 7) {
    connection.credentials.tls_cert_file = argv[5];
    connection.credentials.tls_key_file = argv[6];
  }
  const auto client = lv::Client::Connect(argv[1], {}, connection);
  if (!client.ok()) return example::Fail(client.status());

  lv::VoxelizeRequest request;
  request.resolution = 64;
  const auto all = client->VoxelizeAll(request, *mesh);
  if (!all.ok()) return example::Fail(all.status());
  std::printf("%llu voxels\n", static_cast<unsigned long long>(all->summary.voxels));
}
