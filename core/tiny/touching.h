// Which triangles any lattice edge can meet at all.
#ifndef LATVOX_CORE_TINY_TOUCHING_H_
#define LATVOX_CORE_TINY_TOUCHING_H_

#include "core/tiny/line_forms.h"
#include "core/triangles/corner_list.h"

namespace latvox {

// Leaves, in their order, those triangles that a lattice line along some direction may meet; the others cross no
// lattice edge and contribute nothing.
//
// A line along q is a point (a, b) of the projection along q (core/lattice/frame.h). It can only meet a triangle whose
// corners lie on both sides of a, and on both sides of b. Rows of frames are few linear forms, shared by many frames:
// the floors of a form at the corners differ, or no line lies between them. That holds with the shift of
// core/digitize/crossing.h, too, which moves a form with a first nonzero entry above 0 up; forms are turned so.
// Triangles that are not near (core/triangles/corner_list.h) stay.
void KeepTouching(const LineForms& forms, CornerList& triangles);

}  // namespace latvox

#endif  // LATVOX_CORE_TINY_TOUCHING_H_
