{ The host of host.c in Pascal, whose programs trap floating-point exceptions. }
program host;
{$mode objfpc}
uses SysUtils, Math;

const
  lib = 'helibore';  { Windows: libhelibore.dll }

type
  TSettings = packed record
    size: LongWord;
    sectors: LongInt;
    bit_diameter, pitch, start_depth, stop_depth, start_toolface: Double;
    window, most_vertices: Int64;
    power, max_distance, tolerance, angular_scale, kriging_range, nugget: Double;
    neighbors, max_iterations, estimator, direct, threads, instruction_set: LongInt;
  end;
  TPathSettings = packed record
    size: LongWord;
    method, reference, reserved: LongInt;
    head_north, head_east, head_down, extend: Double;
  end;
  TChange = packed record
    size: LongWord;
    reserved: LongInt;
    ranges, settled, accepted, redundant: Int64;
  end;
  TState = packed record
    size: LongWord;
    reserved: LongInt;
    vertices, samples, settled: Int64;
    start_depth: Double;
  end;

function hb_last_error: PChar; cdecl; external lib;
function hb_close(handle: Int64): LongInt; cdecl; external lib;
function hb_settings_init(var settings: TSettings): LongInt; cdecl; external lib;
function hb_path_settings_init(var settings: TPathSettings): LongInt; cdecl; external lib;
function hb_wall_create(var settings: TSettings; out wall: Int64): LongInt; cdecl; external lib;
function hb_wall_append(wall, n: Int64; depth, toolface, radius, time: PDouble; var change: TChange): LongInt; cdecl; external lib;
function hb_wall_get(wall: Int64; var state: TState): LongInt; cdecl; external lib;
function hb_path_create(var settings: TPathSettings; n: Int64; depth, inclination, azimuth: PDouble; out path: Int64): LongInt; cdecl; external lib;
function hb_wall_surface(wall, path, start, stop: Int64; var vertex_count: Int64; vertices: PDouble; vertex_index: PInt64; var quad_count: Int64; quads: PInt64): LongInt; cdecl; external lib;

procedure Check(status: LongInt);
begin
  if status <> 0 then
  begin
    WriteLn(status, ': ', hb_last_error);
    Halt(1);
  end;
end;

const
  station_depth: array[0..2] of Double = (0, 500, 1100);
  inclination: array[0..2] of Double = (0, 10, 35);
  azimuth: array[0..2] of Double = (40, 40, 55);
var
  settings: TSettings;
  how: TPathSettings;
  change: TChange;
  state: TState;
  depth, toolface, radius: array[0..999] of Double;
  vertices: array of Double;
  quads: array of Int64;
  wall, path, vertex_count, quad_count: Int64;
  packet, i: LongInt;
begin
  SetExceptionMask([exDenormalized, exUnderflow, exPrecision]);  { as Delphi and Free Pascal start }
  settings.size := SizeOf(settings);
  Check(hb_settings_init(settings));
  settings.bit_diameter := 0.216;
  settings.sectors := 32;
  settings.start_depth := 1000;
  Check(hb_wall_create(settings, wall));
  for packet := 0 to 4 do
  begin
    for i := 0 to 999 do
    begin
      depth[i] := 1000 + packet + i * 0.001;
      toolface[i] := i * 37 mod 360;
      radius[i] := 0.11;
      if packet = 2 then radius[i] := 0.11 + 0.02;
    end;
    change.size := SizeOf(change);
    Check(hb_wall_append(wall, 1000, @depth, @toolface, @radius, nil, change));
    WriteLn(change.accepted, ' samples, ', change.ranges, ' changed ranges, settled to ', change.settled);
  end;
  how.size := SizeOf(how);
  Check(hb_path_settings_init(how));
  Check(hb_path_create(how, 3, @station_depth, @inclination, @azimuth, path));
  state.size := SizeOf(state);
  Check(hb_wall_get(wall, state));
  vertex_count := 0;
  quad_count := 0;
  hb_wall_surface(wall, path, 0, state.vertices, vertex_count, nil, nil, quad_count, nil);
  SetLength(vertices, 3 * vertex_count);
  SetLength(quads, 4 * quad_count);
  Check(hb_wall_surface(wall, path, 0, state.vertices, vertex_count, @vertices[0], nil, quad_count, @quads[0]));
  WriteLn(Format('%d vertices, %d quads, first at %.6f %.6f %.6f', [vertex_count, quad_count, vertices[0], vertices[1], vertices[2]]));
  toolface[17] := NegInfinity;
  if hb_wall_append(wall, 1000, @depth, @toolface, @radius, nil, change) <> 1 then Halt(1);
  WriteLn(hb_last_error);
  Check(hb_close(path));
  Check(hb_close(wall));
end.
