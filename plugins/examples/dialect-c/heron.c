/* The dialect of the Heron B2, a bench mill. (There is none: put yours in its place.)
 *
 *   - A line is a block. Feeds stay in force. G0 is a dog-leg, so that here Z and XY never travel at once.
 *   - Three decimals of a millimetre, four of an inch. Numbers are counted in steps of the last decimal
 *     and written digit by digit: printf would write the decimal comma of the user's country.
 *   - Arcs are in XY, with I and J from start to centre. They are cut into quarters, which rounding can
 *     neither turn around nor make uneven. Helices and arcs in other planes become chords.
 *   - T1 to T20 with M6; G4 P waits seconds; comments stand in brackets.
 */
#include "carvegraph.h"

#include <math.h>
#include <string.h>

#define LIMIT_MM 10000.0
#define LIMIT_MM_PER_MIN 20000.0
#define LIMIT_RPM 60000.0
#define LIMIT_SECONDS 3600.0
#define LAST_TOOL 20u
#define COMMENT_CHARS 60
#define RADIUS_TOLERANCE_MM 0.001 /* radii of an arc that differ by more are somebody's error */
#define CHORD_TOLERANCE_MM 0.002  /* where the program does not say how far chords may leave an arc */
#define LEAST_CHORD_STEPS 10.0    /* arcs shorter than this are lines */
#define MOST_CHORDS 10000.0
#define TURN 6.283185307179586

/* A program being written, and what the mill knows by now. */
typedef struct job {
    const cg_program *program;
    const cg_sink *out, *fault;
    cg_status status; /* nothing is written any more when it is not CG_OK */
    size_t command;   /* the one being written, for messages */
    int decimals;
    double steps_per_mm;
    int known;       /* whether it is known where the tip is */
    int64_t at[3];   /* where it is, as written, in steps */
    double meant[3]; /* the same as meant, in mm */
    int64_t feed;    /* the one in force, in steps; 0: none */
    int spindle, spindle_wanted;
    size_t size;
    char text[1 << 14];
} job;

static void flush(job *j)
{
    if (j->status == CG_OK && j->size > 0 && j->out->write(j->out->data, j->text, j->size) != CG_OK)
        j->status = CG_STOPPED;
    j->size = 0;
}

static void put(job *j, const char *text, size_t size)
{
    if (size > sizeof j->text - j->size)
        flush(j);
    memcpy(j->text + j->size, text, size); /* no text here is longer than a line */
    j->size += size;
}

static void say(job *j, const char *text) { put(j, text, strlen(text)); }

/* A letter and a number of steps of so many decimals. */
static void put_number(job *j, char letter, int64_t steps, int decimals)
{
    char text[32];
    size_t at = sizeof text;
    uint64_t rest = steps < 0 ? 0 - (uint64_t)steps : (uint64_t)steps;
    int count = 0;
    do {
        text[--at] = (char)('0' + rest % 10);
        rest /= 10;
        if (++count == decimals)
            text[--at] = '.';
    } while (rest > 0 || count <= decimals);
    if (steps < 0)
        text[--at] = '-';
    text[--at] = letter;
    put(j, text + at, sizeof text - at);
}

/* Refuses the program; says which command is to blame, and why. */
static void fail(job *j, const char *why)
{
    char number[24];
    size_t at = sizeof number, rest = j->command;
    if (j->status != CG_OK)
        return;
    do
        number[--at] = (char)('0' + rest % 10);
    while ((rest /= 10) > 0);
    j->status = CG_FAILED;
    if (j->fault->write(j->fault->data, "command ", 8) == CG_OK
        && j->fault->write(j->fault->data, number + at, sizeof number - at) == CG_OK
        && j->fault->write(j->fault->data, ": ", 2) == CG_OK)
        (void)j->fault->write(j->fault->data, why, strlen(why));
}

/* Anybody's text: what is left of it can neither leave its brackets nor be taken for an order. */
static void comment(job *j, cg_text text)
{
    char line[COMMENT_CHARS];
    size_t size = text.size < sizeof line ? text.size : sizeof line;
    for (size_t k = 0; k < size; k++) {
        char c = text.data[k];
        int kept = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9')
                   || c == '.' || c == ',' || c == ':' || c == '-';
        line[k] = kept ? c : ' ';
    }
    if (size == 0)
        return;
    say(j, "(- ");
    put(j, line, size);
    say(j, ")\n");
}

/* A point in steps; NaN lies within no limits. */
static int to_steps(job *j, const double mm[3], int64_t steps[3])
{
    for (int k = 0; k < 3; k++) {
        if (!(mm[k] >= -LIMIT_MM && mm[k] <= LIMIT_MM)) {
            fail(j, "a coordinate is not within 10000 mm");
            return 0;
        }
        steps[k] = llround(mm[k] * j->steps_per_mm);
    }
    return 1;
}

/* One block: a word, the axes that are in mask, and I and J if they are given. */
static void block(job *j, const char *word, const int64_t to[3], unsigned mask, const int64_t *ij,
                  int64_t feed)
{
    say(j, word);
    for (unsigned k = 0; k < 3; k++)
        if (mask & 1u << k)
            put_number(j, "XYZ"[k], to[k], j->decimals);
    for (unsigned k = 0; ij != NULL && k < 2; k++)
        put_number(j, "IJ"[k], ij[k], j->decimals);
    if (feed != 0 && feed != j->feed) {
        put_number(j, 'F', feed, j->decimals);
        j->feed = feed;
    }
    say(j, "\n");
}

static unsigned changed(const job *j, const int64_t to[3])
{
    return (unsigned)(to[0] != j->at[0]) | (unsigned)(to[1] != j->at[1]) << 1
           | (unsigned)(to[2] != j->at[2]) << 2;
}

/* Up first, down last; from where nobody knows, Z goes first. */
static void rapid(job *j, const double mm[3])
{
    int64_t to[3];
    if (!to_steps(j, mm, to))
        return;
    unsigned axes = j->known ? changed(j, to) : 7u;
    if (!j->known || to[2] > j->at[2])
        block(j, "G0", to, axes & 4u, NULL, 0);
    if (axes & 3u)
        block(j, "G0", to, axes & 3u, NULL, 0);
    if (j->known && to[2] < j->at[2])
        block(j, "G0", to, 4u, NULL, 0);
    memcpy(j->at, to, sizeof j->at);
    memcpy(j->meant, mm, sizeof j->meant);
    j->known = 1;
}

/* A feed in steps, if a cut may begin; otherwise 0. */
static int64_t cutting_feed(job *j, double mm_per_min)
{
    double steps = mm_per_min * j->steps_per_mm;
    if (!j->known)
        fail(j, "it cuts before it is known where the tip is; begin with a rapid to above the work");
    else if (j->spindle_wanted)
        fail(j, "it cuts with the spindle stopped by a tool change; start it again first");
    else if (!(steps >= 1.0 && mm_per_min <= LIMIT_MM_PER_MIN))
        fail(j, "a feed must be above 0 and at most 20000 mm/min");
    else
        return llround(steps);
    return 0;
}

static void line(job *j, const int64_t to[3], int64_t feed)
{
    if (changed(j, to) != 0)
        block(j, "G1", to, changed(j, to), NULL, feed);
    memcpy(j->at, to, sizeof j->at);
}

static void arc(job *j, const cg_arc *arc)
{
    int64_t feed = cutting_feed(j, arc->mm_per_min), end[3], middle[3];
    double center[3];
    /* First and second axis of the plane, and the one that stands on it. */
    unsigned a = arc->plane == 0 ? 0 : arc->plane == 1 ? 2 : 1, b = (a + 1) % 3, c = (a + 2) % 3;
    memcpy(center, arc->center, sizeof center);
    center[c] = j->meant[c];
    if (feed == 0 || !to_steps(j, arc->to, end) || !to_steps(j, center, middle))
        return;
    double u = j->meant[a] - center[a], v = j->meant[b] - center[b];
    double s = arc->to[a] - center[a], t = arc->to[b] - center[b];
    if (arc->plane > 2 || fabs(hypot(u, v) - hypot(s, t)) > RADIUS_TOLERANCE_MM) {
        fail(j, "start and end of an arc do not lie on one circle");
        return;
    }
    double sense = arc->direction == 0 ? -1.0 : 1.0;
    double sweep = sense * atan2(u * t - v * s, u * s + v * t);
    if (u == s && v == t)
        sweep = TURN;
    else if (sweep < 0.0)
        sweep += TURN;
    int round = arc->plane == 0 && end[2] == j->at[2] && !j->program->lines_only;
    double given = j->program->path_tolerance_mm;
    double leave = (given > 0.0 ? given : CHORD_TOLERANCE_MM) / hypot(u, v);
    double piece = round ? TURN / 4 : 2.0 * acos(leave < 1.0 ? 1.0 - leave : 0.0);
    double count = fmin(fmax(ceil(sweep / piece), 1.0), MOST_CHORDS);
    for (double k = 1.0; k <= count && j->status == CG_OK; k += 1.0) {
        double angle = sense * sweep * k / count, next[3];
        int64_t to[3];
        next[a] = center[a] + u * cos(angle) - v * sin(angle);
        next[b] = center[b] + u * sin(angle) + v * cos(angle);
        next[c] = j->meant[c] + (arc->to[c] - j->meant[c]) * k / count;
        if (k == count)
            memcpy(to, end, sizeof to);
        else if (!to_steps(j, next, to))
            return;
        int64_t ij[2] = {middle[0] - j->at[0], middle[1] - j->at[1]};
        double chord = hypot((double)(to[0] - j->at[0]), (double)(to[1] - j->at[1]));
        if (round && chord >= LEAST_CHORD_STEPS) {
            block(j, sense < 0.0 ? "G2" : "G3", to, 3u, ij, feed);
            memcpy(j->at, to, sizeof j->at);
        } else {
            line(j, to, feed);
        }
    }
    memcpy(j->meant, arc->to, sizeof j->meant);
}

static void command(job *j, const cg_command *c)
{
    int64_t to[3], feed;
    switch (c->kind) {
    case CG_COMMENT:
        if (c->number >= j->program->text_count)
            fail(j, "there is no such text");
        else
            comment(j, j->program->texts[c->number]);
        break;
    case CG_TOOL_CHANGE:
        if (c->number < 1 || c->number > LAST_TOOL) {
            fail(j, "there is no such tool; tools are numbered 1 to 20");
            break;
        }
        say(j, "M5\n");
        put_number(j, 'T', c->number, 0);
        say(j, "M6\nG17\n"); /* whatever the change left */
        j->spindle_wanted |= j->spindle;
        j->spindle = j->known = 0;
        j->feed = 0;
        break;
    case CG_SPINDLE:
        if (!(c->values[0] >= 1.0 && c->values[0] <= LIMIT_RPM)) {
            fail(j, "a spindle speed must be 1 to 60000 rpm");
            break;
        }
        put_number(j, 'S', llround(c->values[0]), 0);
        say(j, c->number == 0 ? "M3\n" : "M4\n");
        j->spindle = 1;
        j->spindle_wanted = 0;
        break;
    case CG_SPINDLE_STOP:
        say(j, "M5\n");
        j->spindle = 0;
        break;
    case CG_DWELL:
        if (!(c->values[0] >= 0.0 && c->values[0] <= LIMIT_SECONDS)) {
            fail(j, "a dwell must be 0 to 3600 s");
            break;
        }
        say(j, "G4");
        put_number(j, 'P', llround(c->values[0] * 1000.0), 3);
        say(j, "\n");
        break;
    case CG_RAPID:
        rapid(j, c->values);
        break;
    case CG_FEED:
        feed = cutting_feed(j, c->values[3]);
        if (feed != 0 && to_steps(j, c->values, to)) {
            line(j, to, feed);
            memcpy(j->meant, c->values, sizeof j->meant);
        }
        break;
    case CG_TURN:
        if (c->number >= j->program->arc_count)
            fail(j, "there is no such arc");
        else
            arc(j, &j->program->arcs[c->number]);
        break;
    default: /* later versions of carve may know more */
        fail(j, "heron does not know this command; update the plugin");
    }
}

static cg_status post(uint32_t index, const cg_program *program, const cg_sink *out, const cg_run *run,
                      const cg_sink *fault)
{
    job j = {.program = program, .out = out, .fault = fault};
    (void)run;
    if (index > 0)
        return CG_NO_SUCH;
    if (program->struct_size < sizeof *program) {
        fail(&j, "this plugin is made for a later version of carve");
        return j.status;
    }
    j.decimals = program->units == 0 ? 3 : 4;
    j.steps_per_mm = program->units == 0 ? 1000.0 : 10000.0 / 25.4;
    comment(&j, program->title);
    for (size_t k = 0; k < program->remark_count && j.status == CG_OK; k++)
        comment(&j, program->remarks[k]);
    say(&j, program->units == 0 ? "G21G90G94G17\n" : "G20G90G94G17\n");
    for (; j.command < program->command_count && j.status == CG_OK; j.command++)
        command(&j, &program->commands[j.command]);
    say(&j, "M5\nM30\n");
    flush(&j);
    return j.status;
}

static uint32_t count(void) { return 1; }

static cg_status describe(uint32_t index, cg_dialect_info *info)
{
    static const cg_dialect_info heron = {
        sizeof heron, CG_DIALECT_ARCS | CG_DIALECT_TOOL_CHANGE,
        CG_TEXT("heron"), CG_TEXT("Heron B2 bench mills"), CG_TEXT("nc"),
    };
    if (index > 0)
        return CG_NO_SUCH;
    if (info->struct_size < sizeof heron)
        return CG_FAILED;
    *info = heron;
    return CG_OK;
}

static const cg_dialect_factory dialects = {sizeof dialects, 0, count, describe, post};
static const cg_about about = {sizeof about, 0, CG_TEXT("heron"), CG_TEXT("1.0.0")};

static cg_status init(const cg_host *host, const cg_sink *fault)
{
    (void)host;
    (void)fault;
    return CG_OK;
}

static int is(cg_text text, const char *name)
{
    return text.size == strlen(name) && memcmp(text.data, name, text.size) == 0;
}

static const void *get_factory(cg_text capability)
{
    if (is(capability, CG_DIALECT))
        return &dialects;
    return is(capability, CG_ABOUT) ? &about : NULL;
}

CG_EXPORT const cg_plugin carvegraph_plugin = {
    CG_MAGIC, CG_ABI_MAJOR, CG_ABI_MINOR, sizeof(cg_plugin), 0, init, get_factory,
};
