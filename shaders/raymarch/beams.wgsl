// Light of the beams that a stretch of a view ray sends to the eye (DESIGN 6.5): scattered once, and what
// the forward peak adds to it. Beam by beam, or from their sums at corners (raymarch/gather.wgsl).

#import "raymarch/towards_eye.wgsl"
#import "raymarch/to_and_fro.wgsl"

// Radius of the ball that has the volume of a cube, over the cube's edge.
const BALL_PER_EDGE: f32 = 0.62;

// Two steps of a ray, whose light is evaluated at one point.
struct Segment {
    // Integral of sigma_t over what is left of the ray: of light that nothing deflects, ...
    sharp: f32,
    // ... and of light that the forward peak may deflect.
    reach: Spectrum,
    // Unscaled optical depth from the eye to the point.
    tau_c: f32,
    // [cells]
    length: f32,
}

struct Scattered {
    single: Spectrum,
    forward: Spectrum,
}

// The light of a segment whose point is p, towards the eye of a ray with this direction.
fn scatter_beams(segment: Segment, p: vec3f, direction: vec3f) -> Scattered {
    let k = spectrum(params.k);
    let albedo = spectrum(params.albedo);
    let near = BALL_PER_EDGE * segment.length;
    let near2 = near * near;
    let tau_size = vec3f(textureDimensions(tau));
    let corners = params.dims + 1u;
    let inside = clamp(p + 1.0, vec3f(0.5), vec3f(corners) - 0.5);
    var scattered: Scattered;
    for (var first = 0u; first < n_beams(); first += PACK) {
        let origin = vec3f(pack_origin(first / PACK, corners, params.packs_per_column));
        var depths = vec4f(0.0);
        var share = vec4f(1.0);
        // Of light that counts as not scattered, where it spreads as it goes.
        var stars = vec4f(0.0);
        var star_share = vec4f(1.0);
        if HAS_RADIAL && first >= params.n_at_corners {
            for (var m = 0u; m < min(PACK, n_beams() - first); m += 1u) {
                let position = beams[first + m].place.xyz;
                let light = radial_lights[first + m - params.n_at_corners];
                let line = p - position;
                let found = radial_depth(light, linear_clamp, params.shape, params.cell_m, HAS_SHADOWS, position, line, length(line));
                depths[m] = found.tau;
                share[m] = found.share;
                stars[m] = found.tau;
                star_share[m] = found.share;
            }
        } else if HAS_SHADOWS {
            let lit = lit_between(tau, vec3u(origin), corners, p + 0.5);
            depths = lit.tau;
            share = lit.share;
            if HAS_WIDENING {
                let lit_star = lit_between(star, vec3u(origin), corners, p + 0.5);
                stars = lit_star.tau;
                star_share = lit_star.share;
            }
        } else {
            depths = textureSampleLevel(tau, linear_clamp, (origin + inside) / tau_size, 0.0);
            if HAS_WIDENING {
                stars = textureSampleLevel(star, linear_clamp, (origin + inside) / tau_size, 0.0);
            }
        }
        var aheads = vec4f(0.0);
        if RETURNS && HAS_VOXELS {
            aheads = textureSampleLevel(ahead, linear_clamp, (origin + inside) / tau_size, 0.0);
        }
        for (var m = 0u; m < min(PACK, n_beams() - first); m += 1u) {
            let beam = beams[first + m];
            var travel = beam.place.xyz;
            var power = spectrum(beam.power);
            var reach = 1e30;
            if HAS_POINTS && beam.place.w > 0.0 {
                let line = p - beam.place.xyz;
                let r2 = dot(line, line);
                travel = line * inverseSqrt(max(r2, 1e-12));
                reach = sqrt(r2);
                // Within the ball that has the volume of a cube of the segment's length the ball's mean, 3 / radius^2.
                let falloff = select(1.0 / max(r2, near2), 3.0 / near2, r2 < near2);
                power = power * (emission_along(beam, travel) * falloff / (params.cell_m * params.cell_m));
            }
            var tau_n = depths[m];
            if !HAS_VOXELS {
                let way = ray_shape(params.shape, p, -travel);
                tau_n = params.shape.sigma_t * max(0.0, min(way.y, reach) - way.x) * params.cell_m;
            }
            let mu = clamp(-dot(travel, direction), -1.0, 1.0);
            let unscattered = share[m] * segment.sharp * exp(-tau_n);
            // E* over E_n, and the depth that K is for.
            var reaching = share[m] * exp_of(-k * tau_n);
            if HAS_WIDENING {
                reaching = star_share[m] * exp_of(-k * stars[m]);
                tau_n = select(stars[m], tau_n, share[m] > 0.0);
            }
            let phases = phases_towards_eye(beam, mu, tau_n + segment.tau_c);
            if HAS_PEAK {
                let deflected = max(segment.reach * reaching - unscattered, Spectrum(0.0));
                scattered.forward += power * deflected * phases.peak;
            }
            scattered.single += power * unscattered * phases.single;
            if RETURNS && beam.place.w <= 0.0 {
                var depth_ahead = aheads[m];
                if !HAS_VOXELS {
                    let way = ray_shape(params.shape, p, travel);
                    depth_ahead = params.shape.sigma_t * max(0.0, way.y - way.x) * params.cell_m;
                }
                let both = both_ways(tau_n, depth_ahead);
                let lit = share[m] * segment.sharp;
                let on = max(lit * both.on - unscattered, Spectrum(0.0));
                scattered.forward += power * (on * backward_phase(0.0, mu) + lit * both.back * backward_phase(1.0, -mu));
            }
        }
    }
    scattered.single *= albedo;
    scattered.forward *= albedo;
    return scattered;
}

// The same from sums at the corners of cells, whose logarithms are linear between them.
fn scatter_sums(segment: Segment, p: vec3f) -> Scattered {
    var single = vec3f(0.0);
    var reaching = vec3f(0.0);
    var unscattered = vec3f(0.0);
    for (var c = 0u; c < {channels}u; c += 1u) {
        let sum = exp(layered(sums, linear_clamp, {channels}u, c, p + 0.5).xyz);
        single[c] = sum.x;
        reaching[c] = sum.y;
        unscattered[c] = sum.z;
    }
    let albedo = params.albedo;
    let deflected = segment.reach * spectrum(vec4f(reaching, 0.0)) - segment.sharp * spectrum(vec4f(unscattered, 0.0));
    var scattered: Scattered;
    scattered.single = spectrum(albedo) * (segment.sharp * spectrum(vec4f(single, 0.0)));
    // More light counts as not scattered than is not: less than none is rounding.
    scattered.forward = spectrum(albedo) * max(deflected, Spectrum(0.0));
    return scattered;
}
