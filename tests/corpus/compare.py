"""Compares the facts of two readers."""

RELATIVE = 1e-6  # of the largest coordinate; three.js keeps coordinates as floats of 24 bits, which are 6e-8 apart
COLOR_STEPS = 1.0  # three.js converts colors to linear ones and back, and rounds halves otherwise


def show(numbers):
    return "[" + " ".join(f"{x:.7g}" for x in numbers) + "]"


def bounds_differ(ours, theirs):
    corners = [*ours["min"], *ours["max"]], [*theirs["min"], *theirs["max"]]
    size = max(abs(x) for x in corners[0] + corners[1])
    return any(abs(x - y) > RELATIVE * size for x, y in zip(*corners))


def colors_differ(ours, theirs):
    return any(abs(x - y) > COLOR_STEPS for name in ("min", "max", "mean") for x, y in zip(ours[name], theirs[name]))


def show_colors(colors):
    return "none" if colors is None else f"{show(colors['min'])} to {show(colors['max'])}, mean {show(colors['mean'])}"


def compare(ours, theirs):
    """Returns the difference as one line; None: the facts are equal, or both readers refuse the file."""
    if "error" in ours or "error" in theirs:
        if "error" not in ours:
            return f"only latvox reads it: {ours['triangles']} triangles; reference: {theirs['error']}"
        if "error" not in theirs:
            return f"only the reference reads it: {theirs['triangles']} triangles; latvox: {ours['error']}"
        return None
    if ours["triangles"] != theirs["triangles"]:
        return f"triangles: {ours['triangles']}, reference {theirs['triangles']}"
    if ours["triangles"] == 0:
        return None
    if bounds_differ(ours, theirs):
        return f"bounds: {show(ours['min'])} to {show(ours['max'])}, reference {show(theirs['min'])} to {show(theirs['max'])}"
    if (ours["colors"] is None) != (theirs["colors"] is None) or (ours["colors"] and colors_differ(ours["colors"], theirs["colors"])):
        return f"colors: {show_colors(ours['colors'])}; reference {show_colors(theirs['colors'])}"
    return None
