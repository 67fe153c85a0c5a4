// The colors in a Stanford PLY file.
#ifndef LATVOX_CLIENT_MESH_FILES_PLY_COLOR_H_
#define LATVOX_CLIENT_MESH_FILES_PLY_COLOR_H_

#include <cstdint>
#include <string>

#include "client/mesh/mesh.h"
#include "client/mesh_files/ply_body.h"
#include "client/mesh_files/ply_header.h"

namespace latvox::client {

// Reads the colors of the vertices or faces of a file: red, green and blue, otherwise diffuse_red and so on, as uchar,
// ushort, or float or double from 0 to 1.
class PlyColors {
 public:
  // `element` must outlive the object.
  explicit PlyColors(const PlyElement& element);

  // Returns whether the element has the properties of a color.
  bool exist() const { return names_ != nullptr; }

  // Reads the property of the element's nth one, if it belongs to the color. Returns false if it does not.
  bool Read(const PlyProperty& property, uint64_t n, PlyBody& body);

  // Returns the color of the last element, as the nearest of 256 steps.
  const Color& color() const { return color_; }

  // Returns the first reason why an element has no color; empty: all have one.
  const std::string& fault() const { return fault_; }

 private:
  uint8_t ToPart(double number, const PlyProperty& property, uint64_t n);

  const std::string& element_;  // its name
  const PlyNames* names_;
  Color color_{};
  std::string fault_;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_PLY_COLOR_H_
