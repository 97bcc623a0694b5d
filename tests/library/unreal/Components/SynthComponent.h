#pragma once

#include "CoreMinimal.h"

struct USynthComponent {
  virtual ~USynthComponent() = default;
  int32 NumChannels = 1;

 protected:
  virtual bool Init(int32& SampleRate) = 0;
  virtual int32 OnGenerateAudio(float* OutAudio, int32 NumSamples) = 0;
  virtual void BeginDestroy() {}
};
