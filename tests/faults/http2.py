"""HTTP/2 by hand: bytes that no gRPC library would send."""


def frame(kind, flags, stream, payload=b""):
    return len(payload).to_bytes(3, "big") + bytes([kind, flags]) + stream.to_bytes(4, "big") + payload


def integer(value):
    """Returns an integer with a prefix of seven bits, by RFC 7541."""
    if value < 127:
        return bytes([value])
    encoded, value = bytearray([127]), value - 127
    while value >= 128:
        encoded.append(value & 127 | 128)
        value >>= 7
    return bytes(encoded + bytes([value]))


def header(name, value, first=0):
    """Returns one field, not compressed; with `first` = 64 it enters the table."""
    return bytes([first]) + integer(len(name)) + name + integer(len(value)) + value


DATA, HEADERS, PRIORITY, RESET, SETTINGS, PING, WINDOW_UPDATE, CONTINUATION = 0, 1, 2, 3, 4, 6, 8, 9
ACKNOWLEDGED, END_STREAM, END_HEADERS = 1, 1, 4
PREFACE = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + frame(SETTINGS, 0, 0)
ACKNOWLEDGMENT = frame(SETTINGS, ACKNOWLEDGED, 0)


def call_fields(path, authority=b"latvox"):
    headers = {
        b":method": b"POST",
        b":scheme": b"http",
        b":path": path,
        b":authority": authority,
        b"te": b"trailers",
        b"content-type": b"application/grpc",
    }
    return b"".join(header(*pair) for pair in headers.items())


def call(stream, path=b"/latvox.v1.Voxelizer/Voxelize"):
    return frame(HEADERS, END_HEADERS, stream, call_fields(path))
