// The shapes that several modules share; the modules are plain JavaScript, and name these in their comments.

// Every module may read the state of App and Alarms and call their actions; only main.js and alarms.js change that state.
type App = Readonly<import('./main.js').App>;
type Alarms = import('./alarms.js').Alarms;
type Camera = import('./camera.js').Camera;
type Context = import('./gl.js').Context;
type Curves = import('./curves.js').Curves;
type Gpu = import('./gpu.js').Gpu;
type Host = import('./host.js').Host;
type Level = import('./tiles.js').Level;
type Notes = import('./notes.js').Notes;
type Path = import('./path.js').Path;
type Store = import('./tiles.js').Store;
type Texture = import('./gl.js').Texture;
type Tile = import('./tiles.js').Tile;
type View = Readonly<import('./view.js').View>;

type Choice = [value: string | number, text: string]; // of a select
type Pair = [number, number]; // two ends, or a place in pixels
type Vector = number[]; // of three

type Floats = ArrayLike<number>;
type Units = 'mm' | 'in' | 'ft';
type Pass = 'latest' | 'first' | 'change';
type Cut = 'top' | 'bottom' | 'north' | 'south';
type Theme = 'light' | 'dark';
type End = 'low' | 'high';

// Boxes and strokes.
interface Box { text: string; left: number; right: number; top: number; bottom: number; ground?: boolean } // on a ground of its own, which hides what was drawn before
interface Canvas extends HTMLCanvasElement { labels: Box[]; strokes: Stroke[]; recorder?: Ink; slide?: Record<string, number> } // recorder: keeps what is drawn (svg.js); slide: widths of the texts that are drawn narrower on it
type Stroke = [x0: number, y0: number, x1: number, y1: number];
interface Ink extends CanvasRenderingContext2D { canvas: Canvas }
interface Hatching { step: number; fill: number; rising: boolean }
interface Rect { left: number; top: number; width: number; height: number }
type Rects = Record<string, Rect>; // by the name of the panel or track
interface Arrangement {
  dips?: boolean; measured?: boolean; rig?: boolean; straight?: boolean; outside?: boolean; tab?: string | null; beside?: number; curves?: number; columns?: [string, number][];
  chosen?: Record<string, number>; order?: string[];
}
interface Palette {
  background: number; paper: string; panel: string; ink: string; soft: string; line: string; grid: string; cursor: string; pin: string; min: string; max: string;
  hatch: string; top: string; zones: Record<ZoneKind, string>; fills: Record<'over' | 'partly over' | 'under', string>; picks: Record<PlaneKind | 'breakout', string>;
}

// The wall.
interface Shape { sectors: number; pitch: number; rows: number; rings?: boolean; startDepth: number; startToolface: number }
interface Attribute { name: string; unit: string; log: boolean; color_map: string; rows?: Pair | null; thin?: number } // thin: height of rows of which the wall has not all
interface Vertex { k: number; depth: number; toolface: number; radius: number; first: number; nearest: number; state: number; attributes: number[] }
interface Bend { top: number; length: number; share(depth: number): number; depth(share: number): number } // true depths in view; measured depth to a share of the height of a track, and back
interface Piece { tile: Tile; top: number; bottom: number }
interface FramesTexture { texture: Texture; first: number; origin: Vector; version: number; path: Path }
interface Frame { centre: Vector; high: Vector; right: Vector; tangent: Vector }
interface Quantity {
  id: string; name: string; mode: number; low: number; high: number; map: string; log: boolean; dynamic: boolean; inView: boolean; chosen: boolean;
  attribute?: number; unit?: string; length?: boolean; rows?: Pair | null; thin?: number;
}
type Colours = Partial<Pick<Quantity, 'low' | 'high' | 'map' | 'log' | 'dynamic' | 'inView' | 'chosen'>>;
interface Cursor { depth: number; toolface: number | null }
interface Aim { depth: number; toolface: number; image?: string } // a cursor on the image of this name
type ZoneKind = 'washout' | 'breakout' | 'key seat' | 'undergauge';
interface Zone { kind: ZoneKind; start: number; stop: number; measure: number; severity: number; confidence: number; measured: number | null; within?: number; toolface?: number; name?: string } // within: half the 95 % interval of the measure, if it is known; toolface: axis of a breakout, side of a key seat; name: in rig mode, if it is not the kind
// A string of rigid bodies, and where it hangs.
type RigidBody = [diameter: number, length: number, position: number];
interface Hanging { name: string; clearance?: number; low?: number | null; high?: number | null; depth?: number | null; at_most?: boolean; short?: number }
interface RigidString { bodies: RigidBody[]; why: string; hanging?: Hanging[]; bit?: number }
interface Hung extends RigidString { bottom: number; clearance: number; low: number; high: number; tightest: number; text?: string; body?: number } // in rig mode: what which body clears there
interface MapRow { means: (number | undefined)[]; between: boolean[]; most: number; lacks: boolean }
interface Strip { version: number; id: string; pass: Pass; values: Float32Array; enlarged: Float32Array; lacks: Uint8Array }
interface RowFigures { version: number; values: Float64Array }
interface TileTurns { version: number; min: Float64Array; max: Float64Array; c2: Float64Array; between: Uint8Array }
interface Profile { min: Float32Array; max: Float32Array; c2: Float32Array; seen: Uint8Array; between: Uint8Array; rows: number }
interface Measured { min: number; max: number; c1: number; c2: number; maxAt: number; area: number; radiusMin: number; radiusMax: number; share: number }
type Placing = (radius: number, sector: number) => Pair;
interface Turn { k: number; radii: Float64Array; sure: Float64Array; between: Uint8Array; measured: Measured; level: Level }

// What one frame shows; `quantity` is the one that was asked for, with the ends of its colours in this frame.
interface Look {
  store: Store; view: View; path: Path; rects: Rects; bitDepth: number | null; oldBit: boolean; asked: Quantity; quantity: Quantity; imagePieces: Piece[]; wallPieces: Piece[];
  imageRect: Rect; wallRect: Rect; background: number; dark: boolean; notes: Note[]; intervals: NamedInterval[]; zones: Zone[]; growing: boolean; arms: Arms | null; string: Hung | null; over: Quantity; glow: (tile: Tile) => number[][];
  held?: Plane; // the plane that the held cursor is on
  light?: Quantity; // the image whose contrast is seen from inside under the colours of radii
}
interface Curtain extends Look { from: number } // the image over the first one, from a share of its width on
interface Looks extends Look { images: Look[]; curtain: Curtain | null } // the first image, and those beside it

// Picks.
interface WallPoint { depth: number; toolface: number; radius: number; measured?: boolean; seen?: boolean; image?: string }
type PlaneKind = 'bed' | 'fracture' | 'healed fracture' | 'induced fracture' | 'fault';
interface AnyPick { key: string; depth: number; toolface: number; radius?: number | null; note?: string; image?: string }
interface PlanePick extends AnyPick { kind: PlaneKind; apparent_dip: number; misfit?: number; points?: number; dip_sigma?: number | null; toolface_sigma?: number | null; aperture?: number | null }
interface BreakoutPick extends AnyPick { kind: 'breakout'; height: number; opening: number; tilt?: number }
interface Note extends AnyPick { kind: 'note'; note: string }
type WallPick = PlanePick | BreakoutPick;
type SavedPick = WallPick | Note;
interface PickChange { key: string; pick: SavedPick | null } // null: it is deleted
type Unsaved = Map<string, SavedPick | null>;
interface Plane {
  a: number; b: number; c: number; frame: Frame & { depth: number }; depth: number; radius: number; misfit: number; dip: number; azimuth: number; apparent: number; deepest: number;
  kind: PlaneKind; pick?: PlanePick; dip_sigma?: number; toolface_sigma?: number; curve?: { key: string; depths: number[] }; // the depths of its curve on an image
}
interface Top { name: string; start: number; picked?: Plane; plane: Plane | null }
interface Planes { kept: Plane[]; boxes: BreakoutPick[]; selected: WallPick | null; current: Plane | null; open: boolean }
type Drag = { act: 'box'; from: Aim } | { act: 'sine'; from: Aim; trace: Map<number, WallPoint> } | { act: 'move'; from: Aim; pick: WallPick } | { act: 'dip'; from: Aim; pick: PlanePick; crest: number };

// Curves along the hole.
interface CurveOffer { name: string; unit: string; low: number; high: number; log: boolean; version: number }
interface Arms { depth: Float64Array; min: Float32Array; max: Float32Array; c2: Float32Array; axis: Float32Array } // diameters by the arms of a tool that has few arms, turn by turn
interface CurveValues { depth: Float64Array; values: Float32Array; step: number }

// Messages.
type NamedInterval = [name: string, start: number, stop: number | null, track?: string, diameter?: number];
interface Handshake {
  intervals?: NamedInterval[]; plan?: number[][];
  session: string; basis: string; basis_text: string; reference: string | null; assumed?: boolean; north?: string; attributes: Attribute[]; radius_unit: number; nearest_unit: number; bit_diameter: number; start_depth: number;
  start_toolface: number; frame_step: number; vertices: number; well: string; template?: Template | null; curves?: string[]; picks_file?: string | null; saves_picks?: boolean; levels: { sectors: number; pitch: number; rows: number; rings?: boolean }[];
}
interface ListedWell { name: string; address: string; length: number; head: Vector | null } // one of several wells
type TightPlace = [top: number, bottom: number, passes: number, sticksAt: number, first: string, tightest: number, body: number, sure?: number | null, within?: number | null, most?: boolean]; // how sure it is that the string sticks, half the interval of what passes, and whether it passes at most
interface TightAhead { places: TightPlace[] } // from that which the string meets first
interface Outlook { up: TightAhead | null; down: TightAhead | null; bodies: [up: number | null, down: number | null][]; moving: '' | 'up' | 'down'; hangs?: boolean; same?: number; unseen?: (Pair | null)[][] }
type Way = 'up' | 'down';
interface Meeting { left: number; first: string; way: Way }
interface FirstPlace { start: number; stop: number; measure: number; zone: Zone | null; sure: number; way: Way | ''; left: number; first: string; tight: boolean; may?: boolean; within?: number; most?: boolean; fresh?: boolean } // left: metres until `first` meets it
interface State {
  channels?: number; ahead?: Outlook | null;
  begun: boolean; sources: string; bit_depth: number | null; hole_depth: number | null; seen_hole?: number | null; tripped?: boolean; newest: number | null; received?: number | null; now: number; ended: boolean; true_depth: Vector | null; ranges: Record<string, Pair>;
  zones: Zone[]; unused?: string; zones_to?: number | null; limits?: number[]; curves?: [string, string, number, number, boolean][]; curves_version?: number; alarms?: string[]; lost?: string[]; prints?: boolean; meshes?: boolean; shape?: string; string?: RigidString | null; units?: Units;
}
interface Message { type: number; live: boolean; level: number; mask: number; tile: number; first: number; count: number; total: number; sequence: number; time: number }
interface Write extends Message { type: 1; texels: Uint16Array; columns: { attribute: number; values: Float32Array }[] }
interface Frames extends Message { type: 3; surveyed: boolean; centre: Float64Array; directions: Float32Array }
interface Socket { // what the page uses of a WebSocket
  readyState: number; binaryType: string; send(text: string): void; close(code: number): void; onmessage(event: { data: string | ArrayBuffer }): void; onclose(event: { code: number; reason: string }): void;
}
interface Handlers {
  handshake: (handshake: Handshake) => void; state: (state: State) => void; picks: (picks: SavedPick[]) => void; write: (message: Write) => void;
  frames: (message: Frames) => void; status: (status: string, words: string) => void;
}
interface Template { scale?: number; unit: Units; track: { kind: string; name: string; names: string[]; width: number | null }[] }
interface Summary {
  start: number; stop: number; // the depths that the figures are of
  volume: number; excess: number | null; coverage: number | null; whole_turns: number; incomplete_turns: number; washed_out?: number | null; without_radius: number | null; volume_text?: string; excess_text?: string;
  mean_diameter: number; least_diameter: number; greatest_diameter: number;
  unmeasured_shape: boolean; // mostly interpolated, by a tool with few arms or a sparse one
}
interface WellHistory { time: number[]; vertices: number[]; bit_depth: (number | null)[] }
interface Past { moment: number; vertices: number; bitDepth: number | null }
interface Contents {
  hello: Handshake; state: State; picks: SavedPick[]; messages: string[]; made: number; address?: string; hosted?: boolean; history?: WellHistory; summary: Summary; curves: Record<string, string>;
}

// Elements of the page by id; any other is an HTMLElement.
type Ids<Names extends string, Kind> = { [id in Names]: Kind };
type Elements = Ids<'gl' | 'histogram' | 'ink' | 'net' | 'polar' | 'run', Canvas>
  & Ids<'camera' | 'curve' | 'cut' | 'datum' | 'mode' | 'map' | 'median' | 'pass' | 'pickClass' | 'quantity' | 'sectionLength' | 'shape' | 'tall' | 'tube' | 'units', HTMLSelectElement>
  & Ids<'box' | 'dipFile' | 'discs' | 'dynamic' | 'fence' | 'goTo' | 'high' | 'inView' | 'log' | 'low' | 'moment' | 'noteText' | 'planes', HTMLInputElement>
  & Ids<'dipKeep' | 'dipRedo' | 'dipRemove' | 'dipUndo', HTMLButtonElement>
  & Ids<'csv' | 'export' | 'glb' | 'las' | 'png' | 'print' | 'printAll' | 'slide' | 'svg', HTMLAnchorElement>
  & Ids<'colour', HTMLDetailsElement>
  & Ids<'help' | 'note', HTMLDialogElement>;
type ElementOf<Id extends string> = Id extends keyof Elements ? Elements[Id] : HTMLElement;
