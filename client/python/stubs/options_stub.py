"""Makes the types of keyword arguments, client/python/latvox/_options.pyi, from the options of the tool.

    PYTHONPATH=build/release/client/python python3 client/python/stubs/options_stub.py

The imports and the shorter names at the top of the file stay as they are.
"""

import pathlib
import re
import textwrap

import latvox

FILE = pathlib.Path(__file__).resolve().parents[1] / "latvox/_options.pyi"

# Types by the name of the value in the tool's help. A flag has none.
TYPES = {
    "": "bool",
    "A": "_Number",
    "ADDRESS": "_Names",
    "auto|BITS": 'Union[Literal["auto"], _Integer]',
    "FACTOR": "_Number",
    "FILE": "_Path",
    "FILE.vdb": "_Path",
    "G": "_Number",
    "I/N": "str",
    "LABEL,...": "_Labels",
    "N": "_Integer",
    "NAME,...": "_Names",
    "OUT": "Union[_Path, Sequence[_Path]]",
    "S|SX,SY,SZ": "Union[_Number, _Numbers]",
    "SECONDS": "_Number",
    "TRACE": "str",
    "W|Wv": "Union[_Number, str]",
}
NUMBERS = re.compile(r"\w+(,\w+)+|a1,a2,a3,b1,...,c3")  # X,Y,Z
WORDS = re.compile(r"[a-z0-9-]+(\|[a-z0-9-]+)+")  # cartesian|bcc

CLASSES = {
    "RequestOptions": ("", "Keywords of a request.", "request"),
    "CallOptions": ("", "Keywords of a call, besides its request.", "call"),
    "ConnectionOptions": ("", "Keywords of a connection.", "connection"),
    "ClientOptions": ("ConnectionOptions, CallOptions", "Keywords of a client.", None),
    "ClientCallOptions": ("RequestOptions, CallOptions", "Keywords of the calls of a client.", None),
    "AllOptions": ("RequestOptions, CallOptions, ConnectionOptions", "Keywords of calls without a client.", None),
}


def type_of(value):
    """Returns the type of an option, from the name of its value."""
    if value in TYPES:
        return TYPES[value]
    if NUMBERS.fullmatch(value):
        return "_Numbers"
    if not WORDS.fullmatch(value):
        raise SystemExit(f"options_stub.py: TYPES has no {value!r}")
    words = (word if word.isdecimal() else f'"{word}"' for word in value.split("|"))
    return f"Literal[{', '.join(words)}]"


def line_of(key, value):
    """Returns the line of an option, or several lines."""
    line = f"    {key}: Optional[{type_of(value)}]"
    return textwrap.fill(line, 120, subsequent_indent="        ", break_on_hyphens=False) + "\n"


def stub():
    """Returns the content of the file."""
    text = FILE.read_text().partition("\nclass ")[0]
    for name, (bases, about, scope) in CLASSES.items():
        text += f'\nclass {name}({bases or "TypedDict"}, total=False):\n    """{about}"""\n'
        options = {key: facts["value"] for key, facts in latvox.KEYWORDS.items() if scope == facts["scope"]}
        text += "".join(line_of(key, value) for key, value in options.items())
    return text


if __name__ == "__main__":
    FILE.write_text(stub())
