/* SPDX-License-Identifier: Apache-2.0 */
/* OpenEXR through the C API of OpenEXRCore. The library writes through our stream into the temporary file;
 * each block of scan lines is collected in one row-major array of pixels with interleaved channels. */
#include "render/image.h"

#include "core/base/file.h"
#include "core/base/memory.h"

#include <errno.h>
#include <openexr.h>
#include <stddef.h>
#include <string.h>
#include <unistd.h>

enum { COUNTER_CHANNELS = 3 };

/* One pixel as it goes into the file. */
typedef struct Pixel {
    float rgb[3];
    float depth;
    uint32_t id;
    float counters[COUNTER_CHANNELS];
} Pixel;

/* The channels of a file; the last COUNTER_CHANNELS exist only in counted frames. */
static const struct {
    const char *name;
    exr_pixel_type_t type;
    size_t offset;  /* in Pixel */
    size_t counter; /* offset in RtTally of a counter channel */
} channels[] = {
    {"R", EXR_PIXEL_FLOAT, offsetof(Pixel, rgb[0]), 0},
    {"G", EXR_PIXEL_FLOAT, offsetof(Pixel, rgb[1]), 0},
    {"B", EXR_PIXEL_FLOAT, offsetof(Pixel, rgb[2]), 0},
    {"Z", EXR_PIXEL_FLOAT, offsetof(Pixel, depth), 0},
    {"id", EXR_PIXEL_UINT, offsetof(Pixel, id), 0},
    {"object_tests", EXR_PIXEL_FLOAT, offsetof(Pixel, counters[0]), offsetof(RtTally, object_tests)},
    {"extent_tests", EXR_PIXEL_FLOAT, offsetof(Pixel, counters[1]), offsetof(RtTally, extent_tests)},
    {"steps", EXR_PIXEL_FLOAT, offsetof(Pixel, counters[2]), offsetof(RtTally, steps)},
};

enum { CHANNELS = sizeof channels / sizeof channels[0], PLAIN_CHANNELS = CHANNELS - COUNTER_CHANNELS };

static int channel_count(const RtFrame *frame) {
    return frame->cost ? CHANNELS : PLAIN_CHANNELS;
}

/* The user data of the library's callbacks. */
typedef struct Stream {
    RtOutput output;
    int reason; /* errno of a failed write; 0: none */
} Stream;

/* The library holds a lock that `report` would wait for, so the caller reports failures. */
static int64_t write_at(exr_const_context_t context, void *user, const void *bytes, uint64_t size,
                        uint64_t offset, exr_stream_error_func_ptr_t report) {
    Stream *stream = user;
    const char *from = bytes;
    (void)context, (void)report;
    for (uint64_t done = 0; done < size;) {
        ssize_t n = pwrite(fileno(stream->output.file), from + done, size - done, (off_t)(offset + done));
        if (n <= 0) {
            stream->reason = n < 0 ? errno : ENOSPC;
            return -1;
        }
        done += (uint64_t)n;
    }
    return (int64_t)size;
}

/* Without a handler the library would print. A handler must not call the context, which is locked. The
 * result says what went wrong. */
static void print_nothing(exr_const_context_t context, exr_result_t code, const char *message) {
    (void)context, (void)code, (void)message;
}

static Pixel make_pixel(const RtFrame *frame, uint32_t x, uint32_t y) {
    RtFootprint f = rt_pixel_footprint(&frame->sampling, x, y);
    uint32_t middle = (f.span - 1) / 2;
    size_t sample = (size_t)(f.row + middle) * frame->sampling.columns + f.column + middle;
    RtVec3 color = rt_frame_pixel(frame, x, y);
    Pixel pixel = {{color.x, color.y, color.z}, frame->depth[sample], frame->object[sample], {0}};
    for (int c = PLAIN_CHANNELS; c < channel_count(frame); c++) {
        size_t counter = channels[c].counter / sizeof(uint64_t);
        pixel.counters[c - PLAIN_CHANNELS] = (float)rt_frame_cost(frame, counter, x, y);
    }
    return pixel;
}

static exr_result_t write_header(exr_context_t context, const RtFrame *frame) {
    int part;
    exr_result_t result = exr_add_part(context, "", EXR_STORAGE_SCANLINE, &part);
    if (result == EXR_ERR_SUCCESS)
        result = exr_initialize_required_attr_simple(context, part, (int32_t)frame->sampling.width,
                                                     (int32_t)frame->sampling.height, EXR_COMPRESSION_ZIP);
    for (int c = 0; c < channel_count(frame) && result == EXR_ERR_SUCCESS; c++)
        result =
            exr_add_channel(context, part, channels[c].name, channels[c].type, EXR_PERCEPTUALLY_LINEAR, 1, 1);
    return result == EXR_ERR_SUCCESS ? exr_write_header(context) : result;
}

/* The library sorts channels by name, so each is looked up. */
static void point_to_pixels(exr_encode_pipeline_t *encoder, const Pixel *pixels, uint32_t width) {
    for (int i = 0; i < encoder->channel_count; i++) {
        exr_coding_channel_info_t *to = &encoder->channels[i];
        for (int c = 0; c < CHANNELS; c++) {
            if (strcmp(to->channel_name, channels[c].name) != 0) continue;
            to->encode_from_ptr = (const uint8_t *)pixels + channels[c].offset;
            to->user_pixel_stride = sizeof(Pixel);
            to->user_line_stride = (int32_t)(sizeof(Pixel) * width);
            to->user_bytes_per_element = 4;
            to->user_data_type = (uint16_t)channels[c].type;
        }
    }
}

/* pixels[lines * width] holds one block. */
static exr_result_t write_blocks(exr_context_t context, const RtFrame *frame, Pixel *pixels, uint32_t lines) {
    uint32_t width = frame->sampling.width, height = frame->sampling.height;
    exr_encode_pipeline_t encoder = EXR_ENCODE_PIPELINE_INITIALIZER;
    exr_result_t result = EXR_ERR_SUCCESS;
    for (uint32_t top = 0; top < height && result == EXR_ERR_SUCCESS; top += lines) {
        for (uint32_t y = top; y < height && y < top + lines; y++) {
            for (uint32_t x = 0; x < width; x++)
                pixels[(size_t)(y - top) * width + x] = make_pixel(frame, x, y);
        }
        exr_chunk_info_t chunk;
        result = exr_write_scanline_chunk_info(context, 0, (int)top, &chunk);
        if (result != EXR_ERR_SUCCESS) break;
        result = top == 0 ? exr_encoding_initialize(context, 0, &chunk, &encoder)
                          : exr_encoding_update(context, 0, &chunk, &encoder);
        if (result != EXR_ERR_SUCCESS) break;
        point_to_pixels(&encoder, pixels, width);
        if (top == 0) result = exr_encoding_choose_default_routines(context, 0, &encoder);
        if (result == EXR_ERR_SUCCESS) result = exr_encoding_run(context, 0, &encoder);
    }
    exr_encoding_destroy(context, &encoder);
    return result;
}

static exr_result_t write_file(Stream *stream, const RtFrame *frame) {
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    init.error_handler_fn = print_nothing;
    init.user_data = stream;
    init.write_fn = write_at;
    exr_context_t context;
    exr_result_t result = exr_start_write(&context, stream->output.path, EXR_WRITE_FILE_DIRECTLY, &init);
    if (result != EXR_ERR_SUCCESS) return result;
    result = write_header(context, frame);
    int32_t lines = 1;
    if (result == EXR_ERR_SUCCESS) result = exr_get_scanlines_per_chunk(context, 0, &lines);
    if (result == EXR_ERR_SUCCESS) {
        Pixel *pixels = rt_alloc((size_t)lines * frame->sampling.width, sizeof(Pixel));
        result = pixels ? write_blocks(context, frame, pixels, (uint32_t)lines) : EXR_ERR_OUT_OF_MEMORY;
        rt_free(pixels);
    }
    exr_result_t finished = exr_finish(&context);
    return result == EXR_ERR_SUCCESS ? finished : result;
}

RtStatus rt_exr_write(const RtFrame *frame, const char *path, RtError *error) {
    Stream stream = {.reason = 0};
    RT_TRY(rt_output_open(&stream.output, path, error));
    exr_result_t result = write_file(&stream, frame);
    if (result == EXR_ERR_SUCCESS) return rt_output_commit(&stream.output, error);
    rt_output_discard(&stream.output);
    if (result == EXR_ERR_OUT_OF_MEMORY) return rt_fail(error, RT_NO_MEMORY, "%s: out of memory", path);
    return rt_fail(error, RT_IO, "%s: writing failed: %s", path,
                   stream.reason ? strerror(stream.reason) : exr_get_default_error_message(result));
}
