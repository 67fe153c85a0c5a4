// The triangles that some lattice link can meet.
#ifndef LATVOX_CORE_TINY_TOUCHING_H_
#define LATVOX_CORE_TINY_TOUCHING_H_

#include "core/tiny/line_forms.h"
#include "core/triangles/corner_list.h"

namespace latvox {

// Keeps, in their order, the triangles that a lattice line along some direction may meet. The others cross no lattice
// link and contribute nothing.
//
// A line along q is a point (a, b) of the projection along q (core/lattice/frame.h). It can only meet a triangle with
// corners on both sides of a, and on both sides of b. Rows of frames are few linear forms, shared by many frames.
// Either the floors of a form at the corners differ, or no line lies between them. That also holds with the shift of
// core/digitize/crossing.h, which moves a form up if its first nonzero entry is above 0; forms are turned that way.
// Triangles that are not near (core/triangles/corner_list.h) stay.
void KeepTouching(const LineForms& forms, CornerList& triangles);

}  // namespace latvox

#endif  // LATVOX_CORE_TINY_TOUCHING_H_
