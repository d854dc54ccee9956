/* A plugin in C with one cutter, "square", and one dialect, "plain"; each -D makes one thing wrong. */
#include "carvegraph.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#ifdef ABORT_AT_LOAD
__attribute__((constructor)) static void leave(void) { abort(); }
#endif

#ifdef HANG_AT_LOAD
__attribute__((constructor)) static void stay(void) { for (;;) { } }
#endif

static cg_status fail(const cg_sink *fault, const char *why) {
    fault->write(fault->data, why, strlen(why));
    return CG_FAILED;
}

/* ---- the cutter ---- */

static const cg_dimension dimensions[] = {
    {CG_TEXT("diameter"), CG_TEXT("Diameter"), CG_UNIT_MM, 0, 6.0, 0.1, 50.0},
};

static uint32_t one(void) {
#ifdef HUGE_COUNT
    return UINT32_MAX;
#else
    return 1;
#endif
}

static cg_status describe_cutter(uint32_t index, cg_cutter_info *info) {
    (void)index;
    info->dimension_count = 1;
    info->dimensions = dimensions;
    info->name = (cg_text)CG_TEXT("square");
    info->about = (cg_text)CG_TEXT("Flat, in C");
#ifdef BAD_UTF8
    info->about = (cg_text)CG_TEXT("\xff\xfe");
#endif
#ifdef BAD_NAME
    info->name = (cg_text)CG_TEXT("../Square");
#endif
#ifdef HUGE_TEXT
    info->about.size = SIZE_MAX;
#endif
    return CG_OK;
}

static cg_status profile(uint32_t index, const double *values, size_t count, cg_text drawing,
                         const cg_segment_sink *segments, const cg_sink *fault) {
    (void)index;
    (void)drawing;
    if (count != 1) return fail(fault, "one dimension is wanted");
    cg_segment line = {CG_LINE, 0, {values[0] / 2, 0}, {0, 0}};
#ifdef NAN_PROFILE
    line.to[0] = NAN;
#endif
#ifdef NEGATIVE_RADIUS
    line.to[0] = -line.to[0];
#endif
#ifdef ENDLESS_PROFILE
    for (;;) {
        line.to[0] += 0.001;
        if (segments->put(segments->data, &line, 1) != CG_OK) return CG_STOPPED;
    }
#endif
#ifdef HUGE_LENGTH
    return segments->put(segments->data, &line, SIZE_MAX / 64);
#endif
    return segments->put(segments->data, &line, 1);
}

static const cg_cutter_factory cutters = {sizeof cutters, 0, one, describe_cutter, profile};

/* ---- the dialect ---- */

static uint32_t one_dialect(void) { return 1; }

static cg_status describe_dialect(uint32_t index, cg_dialect_info *info) {
    (void)index;
    info->flags = 0;
    info->name = (cg_text)CG_TEXT("plain");
    info->about = (cg_text)CG_TEXT("Says how many commands there are, in C");
    info->extension = (cg_text)CG_TEXT("gc");
    return CG_OK;
}

static cg_status post(uint32_t index, const cg_program *program, const cg_sink *out, const cg_run *run,
                      const cg_sink *fault) {
    (void)index;
    (void)run;
    (void)fault;
#ifdef ENDLESS_OUTPUT
    /* Writes on, whatever it is told. */
    while (program->command_count > 10) out->write(out->data, "G0 X0\n", 6);
#endif
#ifdef REFUSE
    if (program->command_count > 10) return fail(fault, "the paper tape is torn");
#endif
    for (size_t i = 0; i < program->command_count; i++) {
        cg_status taken = out->write(out->data, "*\n", 2);
        if (taken != CG_OK) return taken;
    }
    return CG_OK;
}

static const cg_dialect_factory dialects = {sizeof dialects, 0, one_dialect, describe_dialect, post};

/* ---- the plugin ---- */

static cg_status init(const cg_host *host, const cg_sink *fault) {
    (void)host;
#ifdef REFUSE_INIT
    return fail(fault, "no licence");
#endif
    (void)fault;
    return CG_OK;
}

static int is(cg_text text, const char *name) {
    return text.size == strlen(name) && memcmp(text.data, name, text.size) == 0;
}

static const cg_about about = {sizeof about, 0, CG_TEXT("in-c"), CG_TEXT("0.1")};

static const void *get_factory(cg_text capability) {
    if (is(capability, CG_ABOUT)) return &about;
    if (is(capability, CG_CUTTER)) return &cutters;
    if (is(capability, CG_DIALECT)) return &dialects;
    return NULL;
}

#ifdef WRONG_MAGIC
#define MAGIC 42
#else
#define MAGIC CG_MAGIC
#endif
#ifdef NEW_MAJOR
#define MAJOR (CG_ABI_MAJOR + 1)
#else
#define MAJOR CG_ABI_MAJOR
#endif
#ifdef NO_SYMBOL
#define carvegraph_plugin something_else
#endif
#ifdef NO_INIT
#define init NULL
#endif

CG_EXPORT const cg_plugin carvegraph_plugin = {
    MAGIC, MAJOR, CG_ABI_MINOR, sizeof(cg_plugin), 0, init, get_factory,
};
