"""Line charts as SVG text, for light and dark pages."""

import html
import math
from dataclasses import dataclass, field

FONT = "font-family='Helvetica, Arial, sans-serif'"
INK, FAINT, GRID, PAPER = "#222222", "#666666", "#e3e3e3", "#ffffff"
DARK = {  # color -> the same on a dark page
    INK: "#e4e4e4", FAINT: "#a6a6a6", GRID: "#3a3a3a", PAPER: "#181818",
    "#D55E00": "#ff8f4d", "#0072B2": "#5cb8f2", "#009E73": "#3fd6a6", "#8E44AD": "#d9a1f5", "#8a8a8a": "#8f8f8f",
}  # fmt: skip
LEFT, RIGHT, TOP, BOTTOM = 62, 14, 30, 42  # room around the axes
LINE = 24  # of the legend


@dataclass
class Series:
    name: str
    color: str  # a key of DARK
    points: list  # (x, y), ascending x
    dash: str = ""  # as SVG's stroke-dasharray
    marker: str = "circle"  # circle, square, diamond, none
    band: list = field(default_factory=list)  # (x, low, high)
    width: float = 1.8  # of the line; a wide one shows below a narrow one with the same points
    size: float = 2.8  # of the markers, half their width; hollow from 3 on


@dataclass
class Chart:
    title: str
    x_label: str
    y_label: str
    series: list
    level: tuple = None  # (y, name) of a horizontal line
    log: bool = False  # y axis
    x_names: dict = None  # x -> label on the axis; default: numbers

    def svg(self, x0, y0, width, height):
        """Returns the chart with its corner at (x0, y0)."""
        return _Drawing(self, x0, y0, width, height).text()


def figure(charts, columns=2, width=470, height=290):
    """Returns charts in rows, below one legend, as a whole SVG document."""
    charts = list(charts)
    total_width = width * min(columns, len(charts))
    body, legend = _legend(charts, total_width)
    for n, chart in enumerate(charts):
        body.append(chart.svg(width * (n % columns), legend + height * (n // columns), width, height))
    total_height = legend + height * math.ceil(len(charts) / columns)
    return (
        f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {total_width} {total_height}' "
        f"width='{total_width}' height='{total_height}' {FONT}>\n{_dark_style()}"
        f"<rect width='{total_width}' height='{total_height}' {_fill(PAPER)}/>\n" + "\n".join(body) + "\n</svg>\n"
    )


def _legend(charts, width):
    """Returns the drawing of the legend, in as many lines as the width needs, and its height."""
    entries = {series.name: series for chart in charts for series in chart.series}
    entries |= {chart.level[1]: None for chart in charts if chart.level}
    body, x, y = [], LEFT, 15
    for name, series in entries.items():
        if x > LEFT and x + 34 + 7 * len(name) > width:
            x, y = LEFT, y + LINE
        if series:
            body.append(_stroke([(x, y), (x + 28, y)], series))
            body.append(_marker(x + 14, y, series))
        else:
            body.append(f"<path d='M{x} {y}h28' stroke-width='1.5' {_line(INK)}/>")
        body.append(_text(x + 34, y + 4, name, size=13))
        x += 54 + 7 * len(name)
    return body, y + 15


def _fill(color):
    return f"fill='{color}' class='f{color[1:]}'"


def _line(color, fill="none"):
    """Returns the attributes of a line and of its filling."""
    classes = f"s{color[1:]}" + (f" f{fill[1:]}" if fill in DARK else "")
    return f"stroke='{color}' fill='{fill}' class='{classes}'"


def _dark_style():
    rules = "".join(f".f{light[1:]}{{fill:{dark}}}.s{light[1:]}{{stroke:{dark}}}" for light, dark in DARK.items())
    return f"<style>@media(prefers-color-scheme:dark){{{rules}}}</style>\n"


class _Drawing:
    def __init__(self, chart, x0, y0, width, height):
        self.chart = chart
        self.left, self.right = x0 + LEFT, x0 + width - RIGHT
        self.top, self.bottom = y0 + TOP, y0 + height - BOTTOM
        xs = [x for series in chart.series for x, _ in series.points]
        self.x_low, self.x_high = 0, max(xs, default=0) or 1
        self.y_low, self.y_high = self.range_of_data()

    def range_of_data(self):
        ys = [y for series in self.chart.series for _, y in series.points]
        ys += [y for series in self.chart.series for _, low, high in series.band for y in (low, high)]
        if self.chart.level:
            ys.append(self.chart.level[0])
        if self.chart.log:
            ys = [y for y in ys if y > 0] or [1]
            return 10 ** math.floor(math.log10(min(ys))), 10 ** math.ceil(math.log10(max(ys)) + 1e-9)
        low, high = min(ys + [0]), max(ys + [0])
        step = _step(low, high or 1)
        return math.floor(low / step) * step, math.ceil((high + (high - low) * 0.04 + 1e-12) / step) * step

    def x(self, value):
        return self.left + (value - self.x_low) / (self.x_high - self.x_low) * (self.right - self.left)

    def x_name(self, value):
        return self.chart.x_names[value] if self.chart.x_names else f"{value:g}"

    def y(self, value):
        if self.chart.log:
            low, high = math.log10(self.y_low), math.log10(self.y_high)
            share = (math.log10(value) - low) / (high - low)
        else:
            share = (value - self.y_low) / (self.y_high - self.y_low)
        return self.bottom - share * (self.bottom - self.top)

    def text(self):
        chart, out = self.chart, self.axes()
        for series in chart.series:
            if series.band:
                edge = [(x, high) for x, _, high in series.band] + [(x, low) for x, low, _ in reversed(series.band)]
                path = "L".join(f"{self.x(x):.1f} {self.y(y):.1f}" for x, y in edge)
                out.append(f"<path d='M{path}Z' opacity='0.2' {_fill(series.color)}/>")
        if chart.level:
            out.append(f"<path d='M{self.left} {self.y(chart.level[0]):.1f}H{self.right}' stroke-width='1.5' {_line(INK)}/>")
        for series in chart.series:
            places = [(self.x(x), self.y(y)) for x, y in series.points]
            out.append(_stroke(places, series))
            for (px, py), (x, y) in zip(places, series.points):
                out.append(_marker(px, py, series, f"{series.name}, {chart.x_label} {self.x_name(x)}: {y:.4g}"))
        return "\n".join(out)

    def axes(self):
        chart, out = self.chart, []
        for value, label in self.y_ticks():
            y = self.y(value)
            out.append(f"<path d='M{self.left} {y:.1f}H{self.right}' {_line(GRID)}/>")
            if label:
                out.append(_text(self.left - 6, y + 4, label, anchor="end"))
        for value in chart.x_names or _ticks(self.x_low, self.x_high):
            x = self.x(value)
            out.append(f"<path d='M{x:.1f} {self.bottom}v4' {_line(FAINT)}/>")
            out.append(_text(x, self.bottom + 17, self.x_name(value), anchor="middle"))
        out.append(f"<path d='M{self.left} {self.top}V{self.bottom}H{self.right}' {_line(FAINT)}/>")
        middle = (self.top + self.bottom) / 2
        out.append(_text((self.left + self.right) / 2, self.bottom + 34, chart.x_label, anchor="middle"))
        turn = f"transform='rotate(-90 {self.left - 48} {middle})'"
        out.append(_text(self.left - 48, middle, chart.y_label, anchor="middle", extra=turn))
        out.append(_text(self.left, self.top - 11, chart.title, size=13, weight="bold"))
        return out

    def y_ticks(self):
        if not self.chart.log:
            return [(value, f"{value:g}") for value in _ticks(self.y_low, self.y_high)]
        decades = range(round(math.log10(self.y_low)), round(math.log10(self.y_high)) + 1)
        ticks = [(10.0**decade, _power(decade)) for decade in decades]
        if len(ticks) <= 4:
            ticks += [(f * 10.0**decade, "") for decade in decades for f in (2, 5) if f * 10.0**decade < self.y_high]
        return ticks


def _power(decade):
    return f"{10.0 ** decade:g}" if -3 <= decade <= 3 else f"1e{decade}"


def _step(low, high):
    rough = (high - low) / 5
    unit = 10 ** math.floor(math.log10(rough))
    return next(f * unit for f in (1, 2, 5, 10) if f * unit >= rough * 0.999)


def _ticks(low, high):
    step = _step(low, high)
    return [round(n * step, 12) for n in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


def _text(x, y, text, anchor="start", size=12, weight="normal", extra=""):
    return (
        f"<text x='{x:.1f}' y='{y:.1f}' text-anchor='{anchor}' font-size='{size}' font-weight='{weight}' "
        f"{_fill(INK)} {extra}>{html.escape(text)}</text>"
    )


def _stroke(places, series):
    path = "L".join(f"{x:.1f} {y:.1f}" for x, y in places)
    dash = f" stroke-dasharray='{series.dash}'" if series.dash else ""
    return f"<path d='M{path}' stroke-width='{series.width}'{dash} {_line(series.color)}/>" if places else ""


def _marker(x, y, series, tip=""):
    r = series.size
    shapes = {
        "circle": f"<circle cx='{x:.1f}' cy='{y:.1f}' r='{r}'",
        "square": f"<path d='M{x - r:.1f} {y - r:.1f}h{2 * r:.1f}v{2 * r:.1f}h{-2 * r:.1f}z'",
        "diamond": f"<path d='M{x:.1f} {y - 1.4 * r:.1f}l{1.4 * r:.1f} {1.4 * r:.1f}l{-1.4 * r:.1f} {1.4 * r:.1f}l{-1.4 * r:.1f} {-1.4 * r:.1f}z'",
    }
    if series.marker not in shapes:
        return ""
    shape = f"{shapes[series.marker]} stroke-width='1.4' {_line(series.color, PAPER if r >= 3 else series.color)}"
    return f"<g><title>{html.escape(tip)}</title>{shape}/></g>" if tip else f"{shape}/>"
