// SPDX-License-Identifier: Apache-2.0
// The keys of every section of the rig but those of lights (core/lights) and shaders (plugins/shaders). The loader,
// `set`, to_toml and the manual take their names, types and ranges from here.
#include "relume/rig.h"

namespace relume {

namespace {

using enum ParameterType;

constexpr double kLargestId = 4294967295.0;  // IDs are 32 bits wide

constexpr Parameter kRig[] = {
    {.name = "version",
     .type = integer,
     .value = {1},
     .min = 1,
     .max = 1,
     .soft_min = 1,
     .label = "Version",
     .help = "Version of the format that the rig is written in; 1 is the only one."},
    {.name = "include",
     .type = text_list,
     .label = "Include",
     .help =
         "Rigs that are read first and overridden by this one: files, relative to this one's folder, or the names of built-in "
         "rigs. Lights of the same name merge, key by key."},
};

constexpr Parameter kGBuffer[] = {
    {.name = "file",
     .type = text,
     .label = "File",
     .help = "The G-buffer, relative to the rig file; ####, %04d or {frame} stands for the frame number.",
     .has_default = false},
    {.name = "frame",
     .type = integer,
     .min = -2147483648.0,
     .max = 2147483647.0,
     .label = "Frame",
     .help = "The frame that is read of a sequence, where neither the command line nor a program says which.",
     .has_default = false},
    {.name = "part",
     .type = text,
     .label = "Part",
     .help = "Layer or part to take when the file holds several.",
     .has_default = false},
    {.name = "view",
     .type = text,
     .label = "View",
     .help = "View to take of a stereo file, as \"left\".",
     .has_default = false},
    {.name = "alpha",
     .type = choice,
     .label = "Alpha",
     .help = "Whether colours are multiplied by alpha. EXR's are, unless something else wrote them.",
     .choices = "premultiplied|straight",
     .has_default = false},
    {.name = "working_space",
     .type = text,
     .label = "Working space",
     .help =
         "The space that the file's colours and the lights' are in, as \"lin_rec709\". When absent it is read from the file's "
         "chromaticities or metadata.",
     .has_default = false},
    {.name = "normal_variance",
     .type = choice,
     .label = "Normal variance",
     .help =
         "Whether a normal shorter than 1 is a mean over the pixel, which widens the pixel's highlights: at creases one mean "
         "normal stands for several surfaces. \"auto\" (also when absent) asks the pixels; `relume inspect` says what was found.",
     .choices = "auto|on|off",
     .has_default = false},
    {.name = "max_pixels",
     .type = integer,
     .min = 1,
     .max = 1e15,
     .label = "Most pixels",
     .help =
         "A file whose header claims more pixels, in one part or as the frame, is refused before its pixels are read "
         "(2^30 when absent).",
     .has_default = false},
    {.name = "max_channels",
     .type = integer,
     .min = 1,
     .max = 1e9,
     .label = "Most channels",
     .help = "A file with more channels, over all its parts, is refused (4096 when absent).",
     .has_default = false},
    {.name = "max_parts",
     .type = integer,
     .min = 1,
     .max = 1e9,
     .label = "Most parts",
     .help = "A file with more parts is refused (1024 when absent).",
     .has_default = false},
};

constexpr Parameter kChannelRule[] = {
    {.name = "channel",
     .type = text,
     .label = "Channel",
     .help = "Channel or layer of the file, or another file, relative to the rig file.",
     .has_default = false},
    {.name = "part",
     .type = text,
     .label = "Part",
     .help = "Part of the file that the channel is in.",
     .has_default = false},
    {.name = "encoding",
     .type = choice,
     .label = "Encoding",
     .help = "How a vector is stored: as it is, or moved into 0..1 as (v + 1)/2.",
     .choices = "-1..1|0..1",
     .has_default = false},
    {.name = "space",
     .type = choice,
     .label = "Space",
     .help = "Space of a normal, tangent or position: the world, or the camera (+X right, +Y up, looking down −Z).",
     .choices = "world|camera",
     .has_default = false},
    {.name = "flip",
     .type = text,
     .label = "Flip",
     .help = "Axes to negate, as \"y\" for normals with DirectX's green or \"x\" for V-Ray's.",
     .has_default = false},
    {.name = "kind",
     .type = choice,
     .label = "Kind",
     .help = "What a depth measures: the distance along the view axis, or along the pixel's ray.",
     .choices = "planar|ray",
     .has_default = false},
    {.name = "near",
     .soft_max = 100,
     .unit = "scene units",
     .label = "Near",
     .help = "Depth that a normalised depth of 0 stands for.",
     .has_default = false},
    {.name = "far",
     .soft_max = 1000,
     .unit = "scene units",
     .label = "Far",
     .help = "Depth that a normalised depth of 1 stands for.",
     .has_default = false},
    {.name = "invert",
     .type = boolean,
     .min = 0,
     .max = 1,
     .label = "Invert",
     .help = "The channel holds 1 minus the value: glossiness for roughness.",
     .has_default = false},
    {.name = "premultiplied",
     .type = boolean,
     .min = 0,
     .max = 1,
     .label = "Premultiplied",
     .help =
         "The channel was averaged over the pixel together with the background's 0, and is to be divided by coverage.",
     .has_default = false},
};

constexpr Parameter kCamera[] = {
    {.name = "matrix",
     .type = number_list,
     .label = "Matrix",
     .help =
         "16 numbers, row-major, camera to world for column vectors: the position stands in the 4th, 8th and 12th. The camera "
         "looks down its −Z, +Y is up.",
     .count = 16,
     .has_default = false},
    {.name = "fov",
     .min = 0.001,
     .max = 179.999,
     .soft_min = 10,
     .soft_max = 120,
     .unit = "degrees",
     .label = "Field of view",
     .help = "Horizontal field of view of the display window.",
     .has_default = false},
    {.name = "focal_length",
     .min = 1e-6,
     .soft_min = 10,
     .soft_max = 200,
     .unit = "mm",
     .label = "Focal length",
     .help = "With horizontal_aperture, instead of fov; any unit, if both have the same.",
     .has_default = false},
    {.name = "horizontal_aperture",
     .min = 1e-6,
     .soft_min = 10,
     .soft_max = 70,
     .unit = "mm",
     .label = "Horizontal aperture",
     .help = "Width of the film or sensor that the display window shows.",
     .has_default = false},
    {.name = "projection",
     .type = choice,
     .label = "Projection",
     .help = "How the camera projects.",
     .choices = "perspective|orthographic",
     .has_default = false},
    {.name = "width",
     .min = 1e-9,
     .soft_max = 100,
     .unit = "scene units",
     .label = "Width",
     .help = "What an orthographic camera sees across the display window.",
     .has_default = false},
};

constexpr Parameter kLightKeys[] = {
    {.name = "name",
     .type = text,
     .label = "Name",
     .help =
         "Names the light in AOVs (light:NAME), on the command line and for merging. When absent it is the type's name, with a "
         "number where that is taken.",
     .has_default = false},
    {.name = "type",
     .type = text,
     .label = "Type",
     .help = "Kind of light; it decides which other keys there are.",
     .has_default = false},
};

constexpr Parameter kShaderKeys[] = {
    {.name = "use",
     .type = text,
     .label = "Use",
     .help = "The shading model, or \"from_material_expression\": the one that the pixel's shading_model_id names.",
     .has_default = false},
    {.name = "cryptomatte",
     .type = text_list,
     .label = "Cryptomatte",
     .help =
         "Name patterns (* and ?) of the objects or materials that it is for; \"object:NAME\" and \"material:NAME\" mean one kind."},
    {.name = "object_id",
     .type = number_list,
     .min = 0,
     .max = kLargestId,
     .label = "Object ID",
     .help = "Object IDs that it is for."},
    {.name = "material_id",
     .type = number_list,
     .min = 0,
     .max = kLargestId,
     .label = "Material ID",
     .help = "Material IDs that it is for."},
    {.name = "shading_model_id",
     .type = number_list,
     .min = 0,
     .max = kLargestId,
     .label = "Shading-model ID",
     .help = "Shading-model IDs that it is for."},
};

constexpr Parameter kChannelRef[] = {
    {.name = "channel",
     .type = text,
     .label = "Channel",
     .help = "Channel or layer of the file that the parameter is read from.",
     .has_default = false},
    {.name = "scale",
     .value = {1},
     .soft_min = -10,
     .soft_max = 10,
     .label = "Scale",
     .help = "The value is channel · scale + offset."},
    {.name = "offset",
     .value = {0},
     .soft_min = -10,
     .soft_max = 10,
     .label = "Offset",
     .help = "The value is channel · scale + offset."},
};

constexpr Parameter kOutput[] = {
    {.name = "mode",
     .type = choice,
     .label = "Mode",
     .help = "Replace the beauty by the relit picture, or add to it.",
     .choices = "replace|add"},
    {.name = "aovs",
     .type = text_list,
     .label = "AOVs",
     .help =
         "Pictures beside the beauty: \"diffuse\", \"specular\", \"transmission\", and \"light:NAME\" for what one light adds."},
    {.name = "type",
     .type = choice,
     .label = "Type",
     .help = "Pixel type of the file: 16-bit half or 32-bit float.",
     .choices = "half|float"},
    {.name = "compression",
     .type = choice,
     .value = {3},
     .label = "Compression",
     .help = "Compression of the EXR. lj2k, htj2k256, htj2k32 and zstd need a recent OpenEXR to be read again.",
     .choices = "none|rle|zips|zip|piz|pxr24|b44|b44a|dwaa|dwab|htj2k256|htj2k32|lj2k|zstd"},
    {.name = "compression_level",
     .min = 0,
     .max = 1000,
     .soft_max = 100,
     .label = "Compression level",
     .help =
         "Effort of zip and zips, 1 to 9 (4 when absent), or loss of dwaa and dwab (45 when absent; more is smaller).",
     .has_default = false},
    {.name = "metadata",
     .type = choice,
     .label = "Metadata",
     .help =
         "Keep the source's metadata and add relume's own (version, the rig as text, what was understood of the G-buffer), or write none.",
     .choices = "keep|none"},
};

}  // namespace

std::span<const Parameter> rig_parameters() { return kRig; }
std::span<const Parameter> gbuffer_parameters() { return kGBuffer; }
std::span<const Parameter> channel_rule_parameters() { return kChannelRule; }
std::span<const Parameter> camera_parameters() { return kCamera; }
std::span<const Parameter> light_key_parameters() { return kLightKeys; }
std::span<const Parameter> shader_key_parameters() { return kShaderKeys; }
std::span<const Parameter> channel_ref_parameters() { return kChannelRef; }
std::span<const Parameter> output_parameters() { return kOutput; }

}  // namespace relume
