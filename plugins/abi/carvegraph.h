/* The C layout of a Carvegraph plugin, ABI 1.0.
 *
 * A plugin is a shared library that exports one constant:
 *
 *     const cg_plugin carvegraph_plugin = {
 *         CG_MAGIC, CG_ABI_MAJOR, CG_ABI_MINOR, sizeof(cg_plugin), 0, init, get_factory
 *     };
 *
 * The host looks at the magic, then at the major version, calls init, and asks get_factory for a table
 * by capability. A table lists what the plugin offers; each entry is described and called by its index.
 *
 * Rules
 *   - Data crosses as pointer and length. What a call is given is valid until it returns. Tables, and
 *     what a describe gives, stay valid and unchanged for good: a library is never unloaded.
 *   - Results go through sinks that the host provides. Nobody frees what the other side allocated.
 *   - No exception or longjmp crosses. Functions may be called from any thread, several at once.
 *   - A plugin starts no thread that outlives a call and no pool: see cg_host.parallel_for.
 *   - Texts are UTF-8 without a terminator.
 *   - Whoever fills a struct with a struct_size sets it; whoever reads it takes no more than that. Within
 *     a major version structs only grow at their end. Set what is reserved to 0.
 *   - Lengths are mm, right-handed, Z up; the cutter's tip is the controlled point.
 *
 * carvegraph-abi says the same in Rust; a test holds the two together.
 */
#ifndef CARVEGRAPH_H
#define CARVEGRAPH_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define CG_MAGIC 0x4341525645475246ULL /* "CARVEGRF" */
#define CG_ABI_MAJOR 1u
#define CG_ABI_MINOR 0u

#if defined(_WIN32)
#define CG_EXPORT __declspec(dllexport)
#else
#define CG_EXPORT __attribute__((visibility("default")))
#endif

/* Capabilities and the tables that get_factory gives for them. */
#define CG_ABOUT "carvegraph.about/1"     /* cg_about */
#define CG_CUTTER "carvegraph.cutter/1"   /* cg_cutter_factory */
#define CG_DIALECT "carvegraph.dialect/1" /* cg_dialect_factory */
#define CG_NODE "carvegraph.node/1"       /* cg_node_factory */

/* How a call ended. */
typedef uint32_t cg_status;
#define CG_OK 0u       /* done */
#define CG_FAILED 1u   /* refused or failed; the fault sink was told why */
#define CG_STOPPED 2u  /* a sink, or progress, said to stop */
#define CG_PANICKED 3u /* the plugin's own error; what caused it is not called again */
#define CG_NO_SUCH 4u  /* there is nothing at that index */

/* UTF-8 without a terminator; data may be null if size is 0. */
typedef struct cg_text {
    const char *data;
    size_t size;
} cg_text;

/* A cg_text of a string literal. */
#define CG_TEXT(literal) {(literal), sizeof(literal) - 1}

/* Takes bytes: a program, or the message of a fault. Anything but CG_OK means: write no more, return. */
typedef struct cg_sink {
    void *data;
    cg_status (*write)(void *data, const char *bytes, size_t size);
} cg_sink;

/* One run of a node or post, to be handed back to the services of the host. */
typedef struct cg_run cg_run;

/* What the host does for a plugin. Valid for good. */
typedef struct cg_host {
    uint32_t struct_size;
    uint32_t abi_major;
    uint32_t abi_minor;
    uint32_t reserved;
    /* Tells the user something: level 0 is a note, 1 a warning. */
    void (*log)(const cg_run *run, uint32_t level, cg_text message);
    /* Tells how much is done, from 0 to 1; answers CG_OK to go on or CG_STOPPED. */
    cg_status (*progress)(const cg_run *run, double share);
    /* Calls body with each index below count on the host's threads, several at once, and returns when
     * all are done. A loop within a loop runs on one thread. */
    cg_status (*parallel_for)(const cg_run *run, size_t count, void (*body)(void *data, size_t index),
                              void *data);
} cg_host;

/* What a library exports as carvegraph_plugin. */
typedef struct cg_plugin {
    uint64_t magic;
    uint32_t abi_major;
    uint32_t abi_minor;
    uint32_t struct_size;
    uint32_t reserved;
    /* Called once, before anything else; refuses by CG_FAILED and a message. */
    cg_status (*init)(const cg_host *host, const cg_sink *fault);
    /* The table of a capability, null if the plugin does not have it. */
    const void *(*get_factory)(cg_text capability);
} cg_plugin;

/* Optional: what a plugin says of itself, for `carve plugins install`. */
typedef struct cg_about {
    uint32_t struct_size;
    uint32_t reserved;
    cg_text id; /* lower case, digits, _ - and . */
    cg_text version;
} cg_about;

/* ---- Cutters ---------------------------------------------------------------------------------- */

#define CG_UNIT_MM 0u
#define CG_UNIT_DEG 1u

/* One dimension of a cutter shape. */
typedef struct cg_dimension {
    cg_text name;
    cg_text about;
    uint32_t unit;
    uint32_t reserved;
    double default_value; /* within min .. max */
    double min;
    double max;
} cg_dimension;

/* What a cutter shape is. The host sets struct_size to the bytes that may be filled. */
typedef struct cg_cutter_info {
    uint32_t struct_size;
    uint32_t dimension_count;
    cg_text name;                   /* lower case, digits and _ */
    cg_text about;                  /* a line */
    cg_text drawing;                /* what its drawing (SVG) must show, in a line; empty: needs none */
    const cg_dimension *dimensions; /* "diameter" first */
} cg_cutter_info;

#define CG_LINE 0u
#define CG_ARC 1u /* curves upward: centre above its end and not right of its start */

/* One piece of a profile, from the end of the one before; the first begins at the tip (0, 0). Neither
 * the distance from the axis nor the height may fall. */
typedef struct cg_segment {
    uint32_t kind;
    uint32_t reserved;
    double to[2];     /* distance from the axis, height above the tip */
    double center[2]; /* of an arc, likewise */
} cg_segment;

/* Takes segments, from the tip outwards. */
typedef struct cg_segment_sink {
    void *data;
    cg_status (*put)(void *data, const cg_segment *segments, size_t count);
} cg_segment_sink;

/* The table of CG_CUTTER. */
typedef struct cg_cutter_factory {
    uint32_t struct_size;
    uint32_t reserved;
    uint32_t (*count)(void);
    cg_status (*describe)(uint32_t index, cg_cutter_info *info);
    /* One value for each dimension, in the order of the description and within its range. */
    cg_status (*profile)(uint32_t index, const double *values, size_t count, cg_text drawing,
                         const cg_segment_sink *segments, const cg_sink *fault);
} cg_cutter_factory;

/* ---- Dialects --------------------------------------------------------------------------------- */

#define CG_DIALECT_ARCS 1u           /* takes arcs */
#define CG_DIALECT_TOOL_CHANGE 2u    /* takes tool changes */
#define CG_DIALECT_PATH_TOLERANCE 4u /* is told the path tolerance */

/* What a dialect is. The host sets struct_size to the bytes that may be filled. */
typedef struct cg_dialect_info {
    uint32_t struct_size;
    uint32_t flags;
    cg_text name;      /* lower case, digits and _ */
    cg_text about;     /* the controllers it is for, in a line */
    cg_text extension; /* of its programs, without the dot */
} cg_dialect_info;

/* Kinds of command. More may come: refuse one that you do not know. */
#define CG_COMMENT 0u      /* number: index into texts */
#define CG_TOOL_CHANGE 1u  /* number: of the tool. Spindle off first; the tip is anywhere after */
#define CG_SPINDLE 2u      /* number: 0 clockwise, 1 counter-clockwise; values[0]: rpm */
#define CG_SPINDLE_STOP 3u
#define CG_DWELL 4u        /* values[0]: seconds */
#define CG_RAPID 5u        /* values[0..2]: end. Z and XY never at once: up first, down last */
#define CG_FEED 6u         /* values[0..2]: end; values[3]: mm/min */
#define CG_TURN 7u         /* number: index into arcs */

/* One step of a program. Only what its kind names has a value. */
typedef struct cg_command {
    uint32_t kind;
    uint32_t number;
    double values[4];
} cg_command;

/* An arc from where the tip is, a helix if its end lies off the plane; equal start and end in the plane
 * are one full turn. */
typedef struct cg_arc {
    uint32_t plane;     /* 0 XY, 1 ZX, 2 YZ */
    uint32_t direction; /* seen against the axis that stands on the plane: 0 clockwise, 1 counter- */
    double center[3];   /* the coordinate off the plane does not count */
    double to[3];
    double mm_per_min;
} cg_arc;

/* The block that is cut from. */
typedef struct cg_stock {
    double min[3];
    double max[3];
} cg_stock;

/* A whole program, in mm whatever its units are. Its end is not a command: post writes it. */
typedef struct cg_program {
    uint32_t struct_size;
    uint32_t units; /* what the text is to be in: 0 mm, 1 inches */
    cg_text title;  /* any text: make it harmless */
    const cg_text *remarks;
    size_t remark_count;
    double path_tolerance_mm; /* 0 if not said */
    const cg_stock *stock;    /* null if not known */
    const cg_command *commands;
    size_t command_count;
    const cg_text *texts;
    size_t text_count;
    const cg_arc *arcs;
    size_t arc_count;
    uint32_t lines_only; /* not 0: write arcs as straight moves */
    uint32_t reserved;
} cg_program;

/* The table of CG_DIALECT. */
typedef struct cg_dialect_factory {
    uint32_t struct_size;
    uint32_t reserved;
    uint32_t (*count)(void);
    cg_status (*describe)(uint32_t index, cg_dialect_info *info);
    cg_status (*post)(uint32_t index, const cg_program *program, const cg_sink *out, const cg_run *run,
                      const cg_sink *fault);
} cg_dialect_factory;

/* ---- Nodes ------------------------------------------------------------------------------------ */

#define CG_PARAM_NUMBER 0u  /* number, in its unit */
#define CG_PARAM_INTEGER 1u /* number */
#define CG_PARAM_SWITCH 2u  /* number: 1 or 0 */
#define CG_PARAM_TEXT 3u    /* text */
#define CG_PARAM_CHOICE 4u  /* text: one of the options */

/* One word that a param may be set to. */
typedef struct cg_param_option {
    cg_text name;
    cg_text about;
} cg_param_option;

/* One parameter of a node. */
typedef struct cg_param {
    cg_text name;
    cg_text about;
    uint32_t kind;
    uint32_t option_count;
    cg_text unit; /* "mm", "mm/min", "deg", "rpm", "s", "px", "%" or empty */
    double default_number;
    cg_text default_text;
    double min;
    double max;
    const cg_param_option *options;
} cg_param;

/* One port of a node. */
typedef struct cg_port {
    cg_text name;
    cg_text about;
    cg_text type_name;
    uint32_t optional; /* not 0: an input that may be left open */
    uint32_t reserved;
} cg_port;

/* What a node is. The host sets struct_size to the bytes that may be filled. */
typedef struct cg_node_info {
    uint32_t struct_size;
    uint32_t version; /* raised whenever the same inputs give other outputs than before */
    cg_text name;     /* lower case, digits and _ */
    cg_text about;
    const cg_param *params;
    size_t param_count;
    const cg_port *inputs;
    size_t input_count;
    const cg_port *outputs;
    size_t output_count;
} cg_node_info;

/* What a param is set to. */
typedef struct cg_argument {
    uint32_t kind;
    uint32_t reserved;
    double number;
    cg_text text;
} cg_argument;

/* Elements of arrays. */
#define CG_U8 0u
#define CG_U16 1u
#define CG_U32 2u
#define CG_U64 3u
#define CG_F32 4u
#define CG_F64 5u

/* A named array of a value. */
typedef struct cg_array {
    cg_text name;
    uint32_t element;
    uint32_t reserved;
    const void *data; /* aligned for its elements */
    size_t count;     /* of elements: n points in space have 3 n */
} cg_array;

/* A value at a port: a type, and its arrays in this order, no other. A text is the array of its UTF-8
 * bytes. Points are x y z (or x y), one after the other, in mm; surfaces are grids or triangles. What
 * carve gives is well-formed and finite; what it is given is checked, and refused with a message.
 *
 *   type         array             element         count
 *   bounds       min_mm            f64             3        the corner with the least x, y, z
 *                max_mm            f64             3        the corner with the greatest
 *   cutter       name              u8              any      what people call it; a text
 *                segment_kinds     u8              n        of its profile: CG_LINE or CG_ARC
 *                segment_ends      f64             2 n      as cg_segment.to
 *                segment_centers   f64             2 n      as cg_segment.center; 0 0 for a line
 *   gcode        text              u8              any      the program, as the controller wants it
 *                dialect           u8              any      what it is written in; a text
 *                extension         u8              any      of its file, without the dot; a text
 *   gray_image   width             u64             1        pixels across
 *                height            u64             1        pixels down
 *                values            f32             w h      row by row from the top; 0 black, 1 white
 *   height_field columns           u64             1        nodes along x, 2 or more
 *                rows              u64             1        nodes along y, 2 or more
 *                pitch_mm          f64             1        between neighbours along x and y
 *                heights           f32             c r      row by row from y = 0, x fastest
 *   image        width             u64             1        pixels across
 *                height            u64             1        pixels down
 *                channels          u64             1        1 gray, 2 + opacity, 3 r g b, 4 + opacity
 *                samples           u8/u16/f32      w h c    pixel by pixel, row by row from the top;
 *                                                           white is 255, 65535 or 1
 *   mesh         vertices          f64             3 v      points
 *                triangles         u32             3 t      three vertices each, from 0, counter-
 *                                                           clockwise seen from outside
 *   pattern      points            f64             2 n      x y, in the order in which they are visited
 *                span_points       u64             s        points of each run: 1 or more, n in all
 *                span_links        u8              s        1: joins two passes, 0: is a pass
 *                span_joined       u8              s        1: is reached along the surface from the
 *                                                           run before, 0: the cutter is lifted over
 *   point_cloud  points            f64             3 n      points
 *                grid              u64             2 or 0   columns, rows: if they are a grid's nodes,
 *                                                           row by row, x fastest
 *   reduction    points_in         u64             1        points of passes and links before
 *                points_out        u64             1        and after
 *                max_deviation_mm  f64             1        of the path from a point left out
 *                max_above_mm      f64             1        of the path above one: material stays
 *                max_below_mm      f64             1        of the path below one: a gouge
 *   remark       text              u8              any      a sentence for the summary
 *   toolpath     tips              f64             3 n      the cutter's tip, in the order of the moves
 *                contact_points    f64             3 n      where it touches; 0 0 0 where it does not
 *                contact_kinds     u8              n        0 nothing, 1 facet, 2 edge, 3 vertex
 *                span_points       u64             s        points of each run: 1 or more, n in all
 *                span_kinds        u8              s        0 pass, 1 link, 2 plunge, 3 rapid
 *                span_joined       u8              s        1: goes on from the last point of the run
 *                                                           before, 0: the cutter is lifted over
 *                feeds_mm_per_min  f64             3 or 0   of passes and links, of plunges, of rapids
 */
typedef struct cg_value {
    cg_text type_name;
    const cg_array *arrays;
    size_t array_count;
} cg_value;

/* Takes the values of output ports, once each; copies them. Anything but CG_OK means: refused, return. */
typedef struct cg_value_sink {
    void *data;
    cg_status (*put)(void *data, uint32_t port, const cg_value *value);
} cg_value_sink;

/* The table of CG_NODE. */
typedef struct cg_node_factory {
    uint32_t struct_size;
    uint32_t reserved;
    uint32_t (*count)(void);
    cg_status (*describe)(uint32_t index, cg_node_info *info);
    /* One argument for each param and one pointer for each input (null where it is left open), in the
     * order of the description. */
    cg_status (*run)(uint32_t index, const cg_argument *arguments, const cg_value *const *inputs,
                     const cg_value_sink *outputs, const cg_run *run, const cg_sink *fault);
} cg_node_factory;

#ifdef __cplusplus
}
#endif

#endif
