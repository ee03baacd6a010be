"""The host of host.c in Python by ctypes: streams samples, then draws a surface along a path. No array library."""

import ctypes
import sys
from ctypes import byref, c_double, c_int32, c_int64, c_uint32

hb = ctypes.CDLL(sys.argv[1])  # libhelibore.so.0.1, libhelibore.dll
hb.hb_last_error.restype = ctypes.c_char_p


class Settings(ctypes.Structure):
    """hb_settings."""

    _fields_ = [("size", c_uint32), ("sectors", c_int32)]
    _fields_ += [(name, c_double) for name in ("bit_diameter", "pitch", "start_depth", "stop_depth", "start_toolface")]
    _fields_ += [(name, c_int64) for name in ("window", "most_vertices")]
    _fields_ += [(name, c_double) for name in ("power", "max_distance", "tolerance", "angular_scale")]
    _fields_ += [(name, c_double) for name in ("kriging_range", "nugget")]
    _fields_ += [(name, c_int32) for name in ("neighbors", "max_iterations", "estimator", "direct", "threads")]
    _fields_ += [("instruction_set", c_int32)]


class PathSettings(ctypes.Structure):
    """hb_path_settings."""

    _fields_ = [("size", c_uint32)] + [(name, c_int32) for name in ("method", "reference", "reserved")]
    _fields_ += [(name, c_double) for name in ("head_north", "head_east", "head_down", "extend")]


class Change(ctypes.Structure):
    """hb_change."""

    _fields_ = [("size", c_uint32), ("reserved", c_int32)]
    _fields_ += [(name, c_int64) for name in ("ranges", "settled", "accepted", "redundant")]


class State(ctypes.Structure):
    """hb_wall_state."""

    _fields_ = [("size", c_uint32), ("reserved", c_int32)]
    _fields_ += [(name, c_int64) for name in ("vertices", "samples", "settled")] + [("start_depth", c_double)]


def made(kind: type):
    return kind(size=ctypes.sizeof(kind))


def check(status: int) -> None:
    if status != 0:
        raise ValueError(hb.hb_last_error().decode())


def numbers(values) -> ctypes.Array:
    values = list(values)
    return (c_double * len(values))(*values)


def main() -> None:
    settings, wall, path = made(Settings), c_int64(), c_int64()
    check(hb.hb_settings_init(byref(settings)))
    settings.bit_diameter, settings.sectors, settings.start_depth = 0.216, 32, 1000
    check(hb.hb_wall_create(byref(settings), byref(wall)))

    toolface = numbers(i * 37 % 360 for i in range(1000))
    for packet in range(5):
        depth = numbers(1000 + packet + i * 0.001 for i in range(1000))
        radius = numbers([0.11 + (0.02 if packet == 2 else 0)] * 1000)
        change = made(Change)
        check(hb.hb_wall_append(wall, c_int64(1000), depth, toolface, radius, None, byref(change)))
        print(f"{change.accepted} samples, {change.ranges} changed ranges, settled to {change.settled}")

    how, state = made(PathSettings), made(State)
    check(hb.hb_path_settings_init(byref(how)))
    stations = numbers([0, 500, 1100]), numbers([0, 10, 35]), numbers([40, 40, 55])
    check(hb.hb_path_create(byref(how), c_int64(3), *stations, byref(path)))
    check(hb.hb_wall_get(wall, byref(state)))
    rows, quad_count, stop = c_int64(), c_int64(), c_int64(state.vertices)
    surface = (wall, path, c_int64(0), stop)
    assert hb.hb_wall_surface(*surface, byref(rows), None, None, byref(quad_count), None) == 4  # HB_BUFFER_TOO_SMALL
    vertices, quads = (c_double * (3 * rows.value))(), (c_int64 * (4 * quad_count.value))()
    check(hb.hb_wall_surface(*surface, byref(rows), vertices, None, byref(quad_count), quads))
    north, east, down = vertices[:3]
    print(f"{rows.value} vertices, {quad_count.value} quads, first at {north:.6f} {east:.6f} {down:.6f}")

    toolface[17] = float("-inf")
    assert hb.hb_wall_append(wall, c_int64(1000), depth, toolface, radius, None, None) == 1  # HB_INPUT
    print(hb.hb_last_error().decode())
    check(hb.hb_close(path))
    check(hb.hb_close(wall))


if __name__ == "__main__":
    main()
