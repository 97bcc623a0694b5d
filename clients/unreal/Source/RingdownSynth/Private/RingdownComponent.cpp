#include "RingdownComponent.h"

#include "ringdown.h"

DEFINE_LOG_CATEGORY_STATIC(LogRingdown, Log, All);

namespace {

constexpr int32 kChannels = 2;

void Tell(const ringdown_error& Error) { UE_LOG(LogRingdown, Error, TEXT("%s"), UTF8_TO_TCHAR(Error.sentence)); }

// Unreal is left-handed and in centimetres, Ringdown right-handed and in metres.
struct FMetres {
  double Numbers[3];
  explicit FMetres(const FVector& V) : Numbers{V.X / 100, -V.Y / 100, V.Z / 100} {}
};

}  // namespace

bool URingdownComponent::Init(int32& SampleRate) {
  NumChannels = kChannels;
  if (Mixer) return true;
  ringdown_settings Settings;
  ringdown_settings_init(&Settings, sizeof Settings);
  Settings.sample_rate_hz = SampleRate;
  ringdown_error Error;
  if (ringdown_mixer_create(&Settings, &Mixer, &Error) == RINGDOWN_OK) return true;
  Tell(Error);
  return false;
}

int32 URingdownComponent::AddBody(const FString& Name, const FString& BankFile) {
  ringdown_error Error;
  ringdown_bank* Bank = nullptr;
  uint32_t Body = 0;
  if (ringdown_bank_open(TCHAR_TO_UTF8(*BankFile), &Bank, &Error) != RINGDOWN_OK) {
    Tell(Error);
    return -1;
  }
  const bool bAdded = ringdown_add(Mixer, TCHAR_TO_UTF8(*Name), Bank, &Body, &Error) == RINGDOWN_OK;
  ringdown_bank_release(Bank);
  if (!bAdded) Tell(Error);
  return bAdded ? static_cast<int32>(Body) : -1;
}

void URingdownComponent::Strike(int32 Body, FVector Point, FVector Impulse, float ContactTime) {
  ringdown_error Error;
  const FMetres Place(Point), Push(Impulse);
  if (ringdown_strike(Mixer, 0, Body, Place.Numbers, Push.Numbers, ContactTime, &Error) != RINGDOWN_OK) Tell(Error);
  ringdown_collect(Mixer);
}

int32 URingdownComponent::OnGenerateAudio(float* OutAudio, int32 NumSamples) {
  const FScopeLock Lock(&Playing);
  const int32 Frames = NumSamples / kChannels;
  Left.Init(0, Frames);
  Right.Init(0, Frames);
  if (Mixer) ringdown_render(Mixer, Left.GetData(), Right.GetData(), Frames);
  for (int32 Frame = 0; Frame < Frames; ++Frame) {
    OutAudio[kChannels * Frame] = Left[Frame];
    OutAudio[kChannels * Frame + 1] = Right[Frame];
  }
  return NumSamples;
}

void URingdownComponent::BeginDestroy() {
  {
    const FScopeLock Lock(&Playing);
    ringdown_mixer_destroy(Mixer);
    Mixer = nullptr;
  }
  Super::BeginDestroy();
}
