// Options of the readers of mesh files.
#ifndef LATVOX_CLIENT_MESH_FILES_PARSE_OPTIONS_H_
#define LATVOX_CLIENT_MESH_FILES_PARSE_OPTIONS_H_

namespace latvox::client {

struct ParseOptions {
  bool skip_bad = false;  // go on without broken elements, and warn: BAD_ELEMENTS, with their count and the first one
  bool base_colors = false;  // read Mesh::base_colors, and the files of their images
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_PARSE_OPTIONS_H_
