// The depth of the turned-over set by itself.

@group(1) @binding(2) var alarm_depth: texture_depth_2d;
