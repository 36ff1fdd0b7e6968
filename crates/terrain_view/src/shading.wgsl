// Draws the ground, flat-coloured shapes and lines of constant width into one image.
// Colours are in the gamma space that the user interface composes in.

struct View {
    clip_from_world: mat4x4<f32>,
    eye: vec4<f32>,
    sun: vec4<f32>,          // xyz towards the sun, w ambient light
    origin_cell: vec4<f32>,  // xy centre of cell 0, z metres per cell, w exaggeration of heights
    range: vec4<f32>,        // least and greatest height, contour interval, grid spacing
    image: vec4<f32>,        // width and height in pixels, colouring, overlay strength
    horizon: vec4<f32>,      // colour of distance, distance of the near plane
    world_from_clip: mat4x4<f32>,
    look: vec4<f32>,         // x strength of ground detail, y whether there is a sky, z strength of shadows, w daylight
};

@group(0) @binding(0) var<uniform> view: View;
@group(1) @binding(0) var heights: texture_2d<f32>;
@group(1) @binding(1) var normals: texture_2d<f32>;
@group(1) @binding(2) var overlay: texture_2d<f32>;
@group(1) @binding(3) var smooth_sampler: sampler;
@group(1) @binding(4) var sunlight: texture_2d<f32>;

// The night is bluish, and light enough to read the map by.
fn by_daylight(color: vec3<f32>) -> vec3<f32> {
    return color * mix(vec3<f32>(0.52, 0.57, 0.72), vec3<f32>(1.0), view.look.w);
}

// Low suns are warm.
fn sun_color() -> vec3<f32> {
    let warmth = (1.0 - smoothstep(0.05, 0.4, view.sun.z)) * view.look.w * step(0.5, view.look.z);
    return mix(vec3<f32>(1.0), vec3<f32>(1.06, 0.88, 0.70), warmth);
}

struct GroundVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) uv: vec2<f32>,
};

// `grid` is a corner of a patch (x, y, skirt); `patch_at` the patch's first cell and its stride.
@vertex
fn ground_vertex(@location(0) grid: vec4<u32>, @location(1) patch_at: vec4<u32>) -> GroundVertex {
    let size = vec2<i32>(textureDimensions(heights));
    let cell = clamp(vec2<i32>(patch_at.xy + grid.xy * patch_at.z), vec2<i32>(0), size - 1);
    let drop = f32(grid.z) * f32(patch_at.z) * view.origin_cell.z * 1.5;
    let height = textureLoad(heights, cell, 0).r - drop;
    let world = vec3<f32>(view.origin_cell.xy + vec2<f32>(cell) * view.origin_cell.z, height);
    var out: GroundVertex;
    out.clip = view.clip_from_world * vec4<f32>(world, 1.0);
    out.world = world;
    out.uv = (vec2<f32>(cell) + 0.5) / vec2<f32>(size);
    return out;
}

fn mars(height: f32, slope: f32) -> vec3<f32> {
    let low = vec3<f32>(0.47, 0.29, 0.20);
    let middle = vec3<f32>(0.70, 0.45, 0.30);
    let high = vec3<f32>(0.86, 0.66, 0.49);
    let rock = vec3<f32>(0.38, 0.27, 0.22);
    var color = mix(mix(low, middle, smoothstep(0.0, 0.5, height)), high, smoothstep(0.5, 1.0, height));
    return mix(color, rock, smoothstep(0.25, 0.7, slope) * 0.8);
}

// A perceptually even ramp that survives colour blindness (dark blue, teal, sand, light yellow).
fn ramp(value: f32) -> vec3<f32> {
    let a = vec3<f32>(0.13, 0.19, 0.42);
    let b = vec3<f32>(0.17, 0.46, 0.55);
    let c = vec3<f32>(0.62, 0.69, 0.47);
    let d = vec3<f32>(0.99, 0.91, 0.60);
    let t = clamp(value, 0.0, 1.0) * 3.0;
    return mix(mix(mix(a, b, clamp(t, 0.0, 1.0)), c, clamp(t - 1.0, 0.0, 1.0)), d, clamp(t - 2.0, 0.0, 1.0));
}

fn line_at(value: f32, spacing: f32) -> f32 {
    let scaled = value / spacing;
    let width = max(fwidth(scaled), 1e-5);
    let nearest = abs(fract(scaled - 0.5) - 0.5);
    // Lines closer together than a few pixels would be a grey veil: fade them.
    return (1.0 - smoothstep(0.5, 1.5, nearest / width)) * (1.0 - smoothstep(0.15, 0.4, width));
}

fn hash(cell: vec2<f32>) -> f32 {
    let at = vec2<i32>(cell);
    var n = (u32(at.x) * 1597334677u) ^ (u32(at.y) * 3812015801u);
    n = (n ^ (n >> 16u)) * 2246822519u;
    n = (n ^ (n >> 13u)) * 3266489917u;
    return f32((n >> 8u) & 0xffffu) / 65535.0;
}

// Smooth noise between 0 and 1, and its slope.
fn noise(at: vec2<f32>) -> vec3<f32> {
    let cell = floor(at);
    let f = at - cell;
    let u = f * f * (3.0 - 2.0 * f);
    let du = 6.0 * f * (1.0 - f);
    let a = hash(cell);
    let b = hash(cell + vec2<f32>(1.0, 0.0));
    let c = hash(cell + vec2<f32>(0.0, 1.0));
    let d = hash(cell + vec2<f32>(1.0, 1.0));
    let k = a - b - c + d;
    let value = a + (b - a) * u.x + (c - a) * u.y + k * u.x * u.y;
    return vec3<f32>(value, du * (vec2<f32>(b - a, c - a) + k * u.yx));
}

// A stone in each third cell or so, round, wholly inside its cell: a shade, and a slope.
fn pebbles(at: vec2<f32>, size: f32) -> vec3<f32> {
    let scaled = at / size;
    let cell = floor(scaled);
    let chance = hash(cell + 91.0);
    if (chance > 0.38) { return vec3<f32>(0.0); }
    let radius = 0.10 + 0.22 * hash(cell + 37.0);
    let middle = vec2<f32>(hash(cell + 11.0), hash(cell + 53.0)) * (1.0 - 2.0 * radius) + radius;
    let away = (scaled - cell - middle) / radius;
    let part = length(away);
    let cover = 1.0 - smoothstep(0.80, 1.0, part);
    return vec3<f32>((chance - 0.22) * 0.9, -away * 0.75) * cover;
}

// Grain of the ground down to a centimeter, with stones on it: a shade, and a slope. Sizes below a pixel fade out.
fn grains(at: vec2<f32>, pixel_m: f32) -> vec3<f32> {
    var sum = vec3<f32>(0.0);
    var size = 6.0;
    for (var octave = 0; octave < 7; octave += 1) {
        let strength = 1.0 - smoothstep(0.12, 0.45, pixel_m / size);
        if (strength > 0.0) {
            let own = noise(at / size + f32(octave) * 17.3);
            sum += vec3<f32>((own.x - 0.5) * 0.16, own.yz * 0.13) * strength;
        }
        size *= 0.36;
    }
    size = 0.9;
    for (var octave = 0; octave < 3; octave += 1) {
        let strength = 1.0 - smoothstep(0.03, 0.10, pixel_m / size);
        if (strength > 0.0) { sum += pebbles(at + f32(octave) * 7.7, size) * strength; }
        size *= 0.27;
    }
    return sum;
}

@fragment
fn ground_fragment(in: GroundVertex) -> @location(0) vec4<f32> {
    let smooth_normal = normalize(textureSample(normals, smooth_sampler, in.uv).xyz * 2.0 - 1.0);
    let pixel_m = length(fwidth(in.world.xy));
    var detail = vec3<f32>(0.0);
    if (view.look.x > 0.0) { detail = grains(in.world.xy - view.origin_cell.xy, pixel_m) * view.look.x; }
    let normal = normalize(smooth_normal - vec3<f32>(detail.yz, 0.0));
    let span = max(view.range.y - view.range.x, 1e-3);
    let height = (in.world.z - view.range.x) / span;
    let slope = atan(length(smooth_normal.xy) / max(smooth_normal.z, 1e-3) / view.origin_cell.w);
    let lit = mix(1.0, textureSample(sunlight, smooth_sampler, in.uv).r, view.look.z);
    let direct = (1.0 - view.sun.w) * max(dot(normal, view.sun.xyz), 0.0) * lit;
    // What the sky lights is darker where the ground leans away from it.
    let ambient = view.sun.w * mix(1.0, 0.62 + 0.38 * normal.z, view.look.z);
    let mode = u32(view.image.z);
    var color = mars(height, slope) * (1.0 + detail.x);
    if (mode == 1u) { color = ramp(height); }
    if (mode == 2u) { color = ramp(slope / 0.6); }
    // What lies on the ground is shaded with it, so that the relief stays visible.
    let covered = textureSample(overlay, smooth_sampler, in.uv) * view.image.w;
    color = color * (1.0 - covered.a) + covered.rgb;
    color = by_daylight(color * (0.25 + 0.95 * (ambient + direct * sun_color())));
    // Every fifth contour is darker, so that heights can be counted; the others stay behind what lies on the ground.
    let level = in.world.z / view.origin_cell.w;
    let contour = line_at(level, max(view.range.z, 1e-3));
    let fifth = line_at(level, max(view.range.z * 5.0, 1e-3));
    if (view.range.z > 0.0) { color = mix(color, color * 0.45, max(contour * 0.3, fifth * 0.65)); }
    let grid = max(line_at(in.world.x, max(view.range.w, 1e-3)), line_at(in.world.y, max(view.range.w, 1e-3)));
    if (view.range.w > 0.0) { color = mix(color, vec3<f32>(1.0), grid * 0.28); }
    let away = distance(in.world, view.eye.xyz);
    let haze = smoothstep(0.35, 1.3, away / max(view.eye.w, 1.0)) * 0.35;
    return vec4<f32>(mix(color, view.horizon.rgb, haze), 1.0);
}

struct SkyVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) far: vec4<f32>,
};

// One triangle over the whole image, behind everything.
@vertex
fn sky_vertex(@builtin(vertex_index) corner: u32) -> SkyVertex {
    let at = vec2<f32>(f32(corner & 1u) * 4.0 - 1.0, f32(corner >> 1u) * 4.0 - 1.0);
    var out: SkyVertex;
    out.clip = vec4<f32>(at, 1.0, 1.0);
    out.far = view.world_from_clip * vec4<f32>(at, 0.99, 1.0);
    return out;
}

@fragment
fn sky_fragment(in: SkyVertex) -> @location(0) vec4<f32> {
    let direction = normalize(in.far.xyz / in.far.w - view.eye.xyz);
    let low = vec3<f32>(0.78, 0.63, 0.50);
    let high = vec3<f32>(0.38, 0.34, 0.33);
    var color = mix(low, high, smoothstep(0.0, 0.45, direction.z));
    let toward = max(dot(direction, view.sun.xyz), 0.0);
    let glow = pow(toward, 48.0) * 0.7 + smoothstep(0.99945, 0.9997, toward) * 0.3;
    color = mix(color, vec3<f32>(0.96, 0.93, 0.90) * sun_color(), glow * view.look.w);
    color = by_daylight(color) * mix(0.45, 1.0, view.look.w);
    // Below the horizon is nothing: the ground ends there.
    return vec4<f32>(mix(color, view.horizon.rgb, smoothstep(0.0, 0.12, -direction.z)), 1.0);
}

struct ShapeVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) normal: vec3<f32>,
    @location(1) color: vec4<f32>,
};

@vertex
fn shape_vertex(
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) color: vec4<f32>,
) -> ShapeVertex {
    var out: ShapeVertex;
    out.clip = view.clip_from_world * vec4<f32>(position, 1.0);
    out.normal = normal;
    out.color = color;
    return out;
}

@fragment
fn shape_fragment(in: ShapeVertex) -> @location(0) vec4<f32> {
    let normal = normalize(in.normal);
    let light = 0.40 + 0.08 * normal.z + 0.57 * max(dot(normal, view.sun.xyz), 0.0) * sun_color();
    return vec4<f32>(by_daylight(in.color.rgb * light) * in.color.a, in.color.a);
}

struct LineVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) color: vec4<f32>,
    // Pixels from the middle of the line and half its width, both times the depth, and the depth: their ratios are even on
    // the screen.
    @location(1) across: vec3<f32>,
};

// One instance is a segment; its six vertices are the corners of a quad of constant width on the screen, with room for soft
// edges.
@vertex
fn line_vertex(
    @builtin(vertex_index) corner: u32,
    @location(0) from_width: vec4<f32>,
    @location(1) to_: vec4<f32>,
    @location(2) color: vec4<f32>,
) -> LineVertex {
    let a = view.clip_from_world * vec4<f32>(from_width.xyz, 1.0);
    let b = view.clip_from_world * vec4<f32>(to_.xyz, 1.0);
    var at_end = 0.0;
    if (corner == 1u || corner == 3u || corner == 4u) { at_end = 1.0; }
    var side = -1.0;
    if (corner == 2u || corner == 4u || corner == 5u) { side = 1.0; }
    var out: LineVertex;
    out.color = vec4<f32>(color.rgb * color.a, color.a);
    if (a.w <= 0.01 || b.w <= 0.01) {
        out.clip = vec4<f32>(0.0, 0.0, 2.0, 1.0);
        out.across = vec3<f32>(0.0, 0.0, 1.0);
        return out;
    }
    let radius = from_width.w * 0.5;
    let pixels = view.image.xy * 0.5;
    let direction = (b.xy / b.w - a.xy / a.w) * pixels;
    let along = direction / max(length(direction), 1e-4);
    let across = vec2<f32>(-along.y, along.x) * side * (radius + 1.0);
    let cap = along * (at_end * 2.0 - 1.0) * from_width.w * 0.25;
    let end = mix(a, b, at_end);
    // Towards the eye by a small part of its distance, so that draped lines do not drown in the ground between two
    // samples: as if the end were that much nearer.
    out.across = vec3<f32>(side * (radius + 1.0), radius, 1.0) * end.w;
    out.clip = vec4<f32>(end.xy + (across + cap) / pixels * end.w, end.z - to_.w * view.horizon.w, end.w);
    return out;
}

@fragment
fn line_fragment(in: LineVertex) -> @location(0) vec4<f32> {
    let away = in.across.xy / in.across.z;
    return in.color * clamp(away.y + 0.5 - abs(away.x), 0.0, 1.0);
}
