// The module latvox._latvox. The package around it, in client/python/latvox, is what users see.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "client/python/arguments.h"
#include "client/python/call.h"
#include "client/python/ending.h"
#include "client/python/files.h"
#include "client/python/voxels.h"
#include "client/python/work.h"
#include "client/tool/output/output.h"
#include "client/tool/vdb/program_path.h"

namespace latvox::client::python {
namespace {

namespace py = pybind11;
using py::arg;

using Counted = py::call_guard<Inside>;

void BindVoxels(py::module_& module) {
  py::class_<Voxels, SharedVoxels>(module, "Voxels")
      .def("__len__", [](const Voxels& voxels) { return CountVoxels(voxels); })
      .def_readonly("progress", &Voxels::progress)
      .def_readonly("report", &Voxels::report)
      .def_readonly("is_streamed", &Voxels::is_streamed)
      .def("brick_ijk", &BrickIjk, Counted())
      .def("brick_masks", &BrickMasks, Counted())
      .def("ijk", &Ijk, Counted())
      .def("points", &Points, Counted())
      .def("fields", &FieldNames, Counted())
      .def("names", &NamesOfField, arg("field"), Counted())
      .def("field", &FieldArray, arg("name"), Counted())
      .def("basis",
           [](const Voxels& voxels) {
             const Basis& basis = voxels.all.accepted.grid.basis;
             return std::array{basis.a, basis.b, basis.c};
           })
      .def("origin", [](const Voxels& voxels) { return voxels.all.accepted.grid.origin; })
      .def("voxel_size", [](const Voxels& voxels) { return voxels.all.accepted.grid.voxel_size; })
      .def("neighbors", [](const Voxels& voxels) { return voxels.all.accepted.neighbors; })
      .def("fraction_labels", [](const Voxels& voxels) { return voxels.all.accepted.fraction_labels; })
      .def("index_box",
           [](const Voxels& voxels) -> std::optional<std::pair<Vec3i, Vec3i>> {
             const auto box = IndexBoxOf(voxels);
             return box ? std::optional(std::pair(box->min, box->max)) : std::nullopt;
           })
      .def(
          "dense",
          [](const Voxels& voxels, const std::optional<std::pair<Vec3i, Vec3i>>& box, const std::string& field) {
            return Dense(voxels, box ? std::optional(IndexBox{box->first, box->second}) : std::nullopt, field);
          },
          arg("box"), arg("field"), Counted())
      .def("save", &Save, arg("path"), arg("dense_npy"), arg("array"), arg("allow_http"), Counted());
}

void BindCalls(py::module_& module) {
  py::class_<Connection>(module, "Connection")
      .def(py::init<const py::dict&, const std::string&, const std::string&>(), arg("keywords"), arg("token"),
           arg("program"), Counted())
      .def("close", &Connection::Close, Counted());
  py::class_<Call>(module, "Call")
      .def(py::init<const Connection&, const py::object&, const py::dict&, bool>(), arg("connection"), arg("mesh"),
           arg("keywords"), arg("streams"), Counted())
      .def("wait", &Call::Wait, arg("progress"), Counted())
      .def("next", &Call::Next, Counted())
      .def("cancel", &Call::Cancel);
}

}  // namespace

PYBIND11_MODULE(_latvox, module) {
  module.doc() = "The SDK and the options of the tool. Use the package latvox, which describes them.";
  LeaveOutExitHandlers();
  py::module_::import("atexit").attr("register")(py::cpp_function(&EndWork));
  module.attr("version") = LATVOX_VERSION;
  module.def("keywords", &Keywords);
  module.def("set_program", &SetProgramPath, arg("path"));
  module.def("extensions", &OutputExtensions);
  module.def("open", &OpenFile, arg("path"), Counted());
  module.def("convert", &Convert, arg("path"), arg("keywords"), Counted());
  module.def("merge", &Merge, arg("parts"), arg("out"), Counted());
  BindVoxels(module);
  BindCalls(module);
}

}  // namespace latvox::client::python
