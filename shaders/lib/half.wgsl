// 16-bit floats.

// The largest one that is finite.
const LARGEST_HALF: f32 = 65504.0;
