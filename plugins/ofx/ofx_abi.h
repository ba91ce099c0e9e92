// SPDX-License-Identifier: Apache-2.0
#pragma once

// The binary interface of OpenFX image effects, as far as the node and its test host need it: structures, suites with
// their members in order, and the names that cross the boundary. Declared here so that nothing has to be installed.

#include <cstddef>

extern "C" {

using OfxStatus = int;
using OfxTime = double;

using OfxPropertySetHandle = struct OfxPropertySetStruct*;
using OfxImageEffectHandle = struct OfxImageEffectStruct*;
using OfxImageClipHandle = struct OfxImageClipStruct*;
using OfxImageMemoryHandle = struct OfxImageMemoryStruct*;
using OfxParamHandle = struct OfxParamStruct*;
using OfxParamSetHandle = struct OfxParamSetStruct*;
using OfxMutexHandle = struct OfxMutexStruct*;

struct OfxRectI {
    int x1, y1, x2, y2;
};
struct OfxRectD {
    double x1, y1, x2, y2;
};
struct OfxPointD {
    double x, y;
};
struct OfxRangeD {
    double min, max;
};

struct OfxHost {
    OfxPropertySetHandle host;
    const void* (*fetchSuite)(OfxPropertySetHandle host, const char* name, int version);
};

struct OfxPlugin {
    const char* pluginApi;
    int apiVersion;
    const char* pluginIdentifier;
    unsigned int pluginVersionMajor;
    unsigned int pluginVersionMinor;
    void (*setHost)(OfxHost* host);
    OfxStatus (*mainEntry)(const char* action, const void* handle, OfxPropertySetHandle in, OfxPropertySetHandle out);
};

struct OfxPropertySuiteV1 {
    OfxStatus (*propSetPointer)(OfxPropertySetHandle, const char*, int, void*);
    OfxStatus (*propSetString)(OfxPropertySetHandle, const char*, int, const char*);
    OfxStatus (*propSetDouble)(OfxPropertySetHandle, const char*, int, double);
    OfxStatus (*propSetInt)(OfxPropertySetHandle, const char*, int, int);
    OfxStatus (*propSetPointerN)(OfxPropertySetHandle, const char*, int, void* const*);
    OfxStatus (*propSetStringN)(OfxPropertySetHandle, const char*, int, const char* const*);
    OfxStatus (*propSetDoubleN)(OfxPropertySetHandle, const char*, int, const double*);
    OfxStatus (*propSetIntN)(OfxPropertySetHandle, const char*, int, const int*);
    OfxStatus (*propGetPointer)(OfxPropertySetHandle, const char*, int, void**);
    OfxStatus (*propGetString)(OfxPropertySetHandle, const char*, int, char**);
    OfxStatus (*propGetDouble)(OfxPropertySetHandle, const char*, int, double*);
    OfxStatus (*propGetInt)(OfxPropertySetHandle, const char*, int, int*);
    OfxStatus (*propGetPointerN)(OfxPropertySetHandle, const char*, int, void**);
    OfxStatus (*propGetStringN)(OfxPropertySetHandle, const char*, int, char**);
    OfxStatus (*propGetDoubleN)(OfxPropertySetHandle, const char*, int, double*);
    OfxStatus (*propGetIntN)(OfxPropertySetHandle, const char*, int, int*);
    OfxStatus (*propReset)(OfxPropertySetHandle, const char*);
    OfxStatus (*propGetDimension)(OfxPropertySetHandle, const char*, int*);
};

struct OfxImageEffectSuiteV1 {
    OfxStatus (*getPropertySet)(OfxImageEffectHandle, OfxPropertySetHandle*);
    OfxStatus (*getParamSet)(OfxImageEffectHandle, OfxParamSetHandle*);
    OfxStatus (*clipDefine)(OfxImageEffectHandle, const char*, OfxPropertySetHandle*);
    OfxStatus (*clipGetHandle)(OfxImageEffectHandle, const char*, OfxImageClipHandle*, OfxPropertySetHandle*);
    OfxStatus (*clipGetPropertySet)(OfxImageClipHandle, OfxPropertySetHandle*);
    OfxStatus (*clipGetImage)(OfxImageClipHandle, OfxTime, const OfxRectD*, OfxPropertySetHandle*);
    OfxStatus (*clipReleaseImage)(OfxPropertySetHandle);
    OfxStatus (*clipGetRegionOfDefinition)(OfxImageClipHandle, OfxTime, OfxRectD*);
    int (*abort)(OfxImageEffectHandle);
    OfxStatus (*imageMemoryAlloc)(OfxImageEffectHandle, std::size_t, OfxImageMemoryHandle*);
    OfxStatus (*imageMemoryFree)(OfxImageMemoryHandle);
    OfxStatus (*imageMemoryLock)(OfxImageMemoryHandle, void**);
    OfxStatus (*imageMemoryUnlock)(OfxImageMemoryHandle);
};

struct OfxParameterSuiteV1 {
    OfxStatus (*paramDefine)(OfxParamSetHandle, const char*, const char*, OfxPropertySetHandle*);
    OfxStatus (*paramGetHandle)(OfxParamSetHandle, const char*, OfxParamHandle*, OfxPropertySetHandle*);
    OfxStatus (*paramSetGetPropertySet)(OfxParamSetHandle, OfxPropertySetHandle*);
    OfxStatus (*paramGetPropertySet)(OfxParamHandle, OfxPropertySetHandle*);
    OfxStatus (*paramGetValue)(OfxParamHandle, ...);
    OfxStatus (*paramGetValueAtTime)(OfxParamHandle, OfxTime, ...);
    OfxStatus (*paramGetDerivative)(OfxParamHandle, OfxTime, ...);
    OfxStatus (*paramGetIntegral)(OfxParamHandle, OfxTime, OfxTime, ...);
    OfxStatus (*paramSetValue)(OfxParamHandle, ...);
    OfxStatus (*paramSetValueAtTime)(OfxParamHandle, OfxTime, ...);
    OfxStatus (*paramGetNumKeys)(OfxParamHandle, unsigned int*);
    OfxStatus (*paramGetKeyTime)(OfxParamHandle, unsigned int, OfxTime*);
    OfxStatus (*paramGetKeyIndex)(OfxParamHandle, OfxTime, int, int*);
    OfxStatus (*paramDeleteKey)(OfxParamHandle, OfxTime);
    OfxStatus (*paramDeleteAllKeys)(OfxParamHandle);
    OfxStatus (*paramCopy)(OfxParamHandle, OfxParamHandle, OfxTime, const OfxRangeD*);
    OfxStatus (*paramEditBegin)(OfxParamSetHandle, const char*);
    OfxStatus (*paramEditEnd)(OfxParamSetHandle);
};

struct OfxMessageSuiteV1 {
    OfxStatus (*message)(void* handle, const char* type, const char* id, const char* format, ...);
};
struct OfxMessageSuiteV2 {
    OfxStatus (*message)(void* handle, const char* type, const char* id, const char* format, ...);
    OfxStatus (*setPersistentMessage)(void* handle, const char* type, const char* id, const char* format, ...);
    OfxStatus (*clearPersistentMessage)(void* handle);
};

}  // extern "C"

namespace relume::ofx {

enum Status : int {
    kOk = 0,
    kFailed = 1,
    kErrFatal = 2,
    kErrUnknown = 3,
    kErrMissingHostFeature = 4,
    kErrUnsupported = 5,
    kErrExists = 6,
    kErrFormat = 7,
    kErrMemory = 8,
    kErrBadHandle = 9,
    kErrBadIndex = 10,
    kErrValue = 11,
    kReplyYes = 12,
    kReplyNo = 13,
    kReplyDefault = 14,
};

/// Names of suites, actions, properties and their values.
namespace name {

inline constexpr const char *kImageEffectApi = "OfxImageEffectPluginAPI", *kPropertySuite = "OfxPropertySuite",
                            *kImageEffectSuite = "OfxImageEffectSuite", *kParameterSuite = "OfxParameterSuite",
                            *kMessageSuite = "OfxMessageSuite";

inline constexpr const char *kActionLoad = "OfxActionLoad", *kActionUnload = "OfxActionUnload",
                            *kActionDescribe = "OfxActionDescribe", *kActionCreateInstance = "OfxActionCreateInstance",
                            *kActionDestroyInstance = "OfxActionDestroyInstance",
                            *kActionInstanceChanged = "OfxActionInstanceChanged",
                            *kActionPurgeCaches = "OfxActionPurgeCaches",
                            *kActionSyncPrivateData = "OfxActionSyncPrivateData",
                            *kActionDescribeInContext = "OfxImageEffectActionDescribeInContext",
                            *kActionRegionOfDefinition = "OfxImageEffectActionGetRegionOfDefinition",
                            *kActionRegionsOfInterest = "OfxImageEffectActionGetRegionsOfInterest",
                            *kActionClipPreferences = "OfxImageEffectActionGetClipPreferences",
                            *kActionIsIdentity = "OfxImageEffectActionIsIdentity",
                            *kActionTimeDomain = "OfxImageEffectActionGetTimeDomain",
                            *kActionBeginSequence = "OfxImageEffectActionBeginSequenceRender",
                            *kActionRender = "OfxImageEffectActionRender",
                            *kActionEndSequence = "OfxImageEffectActionEndSequenceRender";

inline constexpr const char *kContextGeneral = "OfxImageEffectContextGeneral",
                            *kContextFilter = "OfxImageEffectContextFilter",
                            *kContextGenerator = "OfxImageEffectContextGenerator";

inline constexpr const char *kRgba = "OfxImageComponentRGBA", *kRgb = "OfxImageComponentRGB",
                            *kAlpha = "OfxImageComponentAlpha";
inline constexpr const char *kDepthByte = "OfxBitDepthByte", *kDepthShort = "OfxBitDepthShort",
                            *kDepthHalf = "OfxBitDepthHalf", *kDepthFloat = "OfxBitDepthFloat";
inline constexpr const char *kPremultiplied = "OfxImageAlphaPremultiplied",
                            *kUnpremultiplied = "OfxImageAlphaUnPremultiplied", *kOpaque = "OfxImageOpaque";

// Properties of everything.
inline constexpr const char *kPropType = "OfxPropType", *kPropName = "OfxPropName", *kPropLabel = "OfxPropLabel",
                            *kPropTime = "OfxPropTime", *kPropChangeReason = "OfxPropChangeReason",
                            *kPropDescription = "OfxPropPluginDescription", *kTypeParameter = "OfxTypeParameter",
                            *kTypeClip = "OfxTypeClip", *kChangeUserEdited = "OfxChangeUserEdited",
                            *kChangePluginEdited = "OfxChangePluginEdited", *kChangeTime = "OfxChangeTime";

// Of an effect, its instances and its actions.
inline constexpr const char *kPropContext = "OfxImageEffectPropContext",
                            *kPropGrouping = "OfxImageEffectPluginPropGrouping",
                            *kPropSupportedContexts = "OfxImageEffectPropSupportedContexts",
                            *kPropSupportedDepths = "OfxImageEffectPropSupportedPixelDepths",
                            *kPropSupportsTiles = "OfxImageEffectPropSupportsTiles",
                            *kPropMultiResolution = "OfxImageEffectPropSupportsMultiResolution",
                            *kPropTemporalAccess = "OfxImageEffectPropTemporalClipAccess",
                            *kPropMultipleDepths = "OfxImageEffectPropMultipleClipDepths",
                            *kPropMultiplePars = "OfxImageEffectPropSupportsMultipleClipPARs",
                            *kPropThreadSafety = "OfxImageEffectPluginRenderThreadSafety",
                            *kFullySafe = "OfxImageEffectRenderFullySafe",
                            *kPropHostFrameThreading = "OfxImageEffectPluginPropHostFrameThreading",
                            *kPropSingleInstance = "OfxImageEffectPluginPropSingleInstance",
                            *kPropProjectSize = "OfxImageEffectPropProjectSize",
                            *kPropProjectOffset = "OfxImageEffectPropProjectOffset",
                            *kPropProjectAspect = "OfxImageEffectPropPixelAspectRatio",
                            *kPropRenderScale = "OfxImageEffectPropRenderScale",
                            *kPropRenderWindow = "OfxImageEffectPropRenderWindow",
                            *kPropRegionOfDefinition = "OfxImageEffectPropRegionOfDefinition",
                            *kPropRegionOfInterest = "OfxImageEffectPropRegionOfInterest",
                            *kPropClipRegionPrefix = "OfxImageClipPropRoI_",
                            *kPropClipDepthPrefix = "OfxImageClipPropDepth_",
                            *kPropClipAspectPrefix = "OfxImageClipPropPAR_",
                            *kPropClipComponentsPrefix = "OfxImageClipPropComponents_",
                            *kPropFrameVarying = "OfxImageEffectFrameVarying",
                            *kPropPremultiplication = "OfxImageEffectPropPreMultiplication";

// Of clips and images.
inline constexpr const char *kPropSupportedComponents = "OfxImageEffectPropSupportedComponents",
                            *kPropOptional = "OfxImageClipPropOptional", *kPropConnected = "OfxImageClipPropConnected",
                            *kPropData = "OfxImagePropData", *kPropBounds = "OfxImagePropBounds",
                            *kPropRowBytes = "OfxImagePropRowBytes",
                            *kPropImageRegionOfDefinition = "OfxImagePropRegionOfDefinition",
                            *kPropComponents = "OfxImageEffectPropComponents",
                            *kPropPixelDepth = "OfxImageEffectPropPixelDepth",
                            *kPropImageAspect = "OfxImagePropPixelAspectRatio";

// Of parameters.
inline constexpr const char *kParamDouble = "OfxParamTypeDouble", *kParamDouble2D = "OfxParamTypeDouble2D",
                            *kParamDouble3D = "OfxParamTypeDouble3D", *kParamRgb = "OfxParamTypeRGB",
                            *kParamInteger = "OfxParamTypeInteger", *kParamBoolean = "OfxParamTypeBoolean",
                            *kParamChoice = "OfxParamTypeChoice", *kParamString = "OfxParamTypeString",
                            *kParamGroup = "OfxParamTypeGroup", *kParamPage = "OfxParamTypePage";
inline constexpr const char *kPropDefault = "OfxParamPropDefault", *kPropMin = "OfxParamPropMin",
                            *kPropMax = "OfxParamPropMax", *kPropDisplayMin = "OfxParamPropDisplayMin",
                            *kPropDisplayMax = "OfxParamPropDisplayMax", *kPropHint = "OfxParamPropHint",
                            *kPropScriptName = "OfxParamPropScriptName", *kPropParent = "OfxParamPropParent",
                            *kPropChoiceOption = "OfxParamPropChoiceOption",
                            *kPropStringMode = "OfxParamPropStringMode", *kStringIsFile = "OfxParamStringIsFilePath",
                            *kStringIsSingleLine = "OfxParamStringIsSingleLine",
                            *kStringIsMultiLine = "OfxParamStringIsMultiLine",
                            *kPropFilePathExists = "OfxParamPropStringFilePathExists",
                            *kPropAnimates = "OfxParamPropAnimates", *kPropSecret = "OfxParamPropSecret",
                            *kPropPageChild = "OfxParamPropPageChild", *kPropDoubleType = "OfxParamPropDoubleType",
                            *kDoublePlain = "OfxParamDoubleTypePlain",
                            *kDoubleXyAbsolute = "OfxParamDoubleTypeXYAbsolute",
                            *kPropGroupOpen = "OfxParamPropGroupOpen",
                            *kPropEvaluateOnChange = "OfxParamPropEvaluateOnChange",
                            *kPropHostOverlay = "kOfxParamPropUseHostOverlayHandle";  // with its k

inline constexpr const char *kClipSource = "Source", *kClipOutput = "Output";
inline constexpr const char *kMessageError = "OfxMessageError", *kMessageWarning = "OfxMessageWarning";

}  // namespace name
}  // namespace relume::ofx
