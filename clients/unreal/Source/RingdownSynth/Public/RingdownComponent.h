// Plays any number of bodies in Unreal by libringdown. Put one component on one actor of the level, add bodies in
// BeginPlay, and call Strike in the event Hit. Points and impulses are in Unreal's units and axes, in the body's own
// frame.
#pragma once

#include "Components/SynthComponent.h"
#include "CoreMinimal.h"
#include "RingdownComponent.generated.h"

struct ringdown_mixer;

UCLASS(ClassGroup = Audio, meta = (BlueprintSpawnableComponent))
class RINGDOWNSYNTH_API URingdownComponent : public USynthComponent {
  GENERATED_BODY()

 public:
  // Returns the body's number, or -1 and a line in the log if the bank cannot be read. Bodies have names of their own.
  UFUNCTION(BlueprintCallable, Category = "Ringdown")
  int32 AddBody(const FString& Name, const FString& BankFile);

  // A blow of kg cm/s at a point in cm. Contact times are seconds: 0.0001 is steel on steel, 0.001 a rubber mallet.
  UFUNCTION(BlueprintCallable, Category = "Ringdown")
  void Strike(int32 Body, FVector Point, FVector Impulse, float ContactTime = 0.0002f);

 protected:
  bool Init(int32& SampleRate) override;
  int32 OnGenerateAudio(float* OutAudio, int32 NumSamples) override;
  void BeginDestroy() override;

 private:
  ringdown_mixer* Mixer = nullptr;
  FCriticalSection Playing;  // held while the audio thread renders, so that the mixer lives as long
  TArray<float> Left, Right;
};
