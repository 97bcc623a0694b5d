// The name is not Ringdown's alone, because Unreal would then define RINGDOWN_API, which ringdown.h defines, too.
using System.IO;
using UnrealBuildTool;

public class RingdownSynth : ModuleRules {
  public RingdownSynth(ReadOnlyTargetRules target) : base(target) {
    PCHUsage = PCHUsageMode.UseExplicitOrSharedPCHs;
    PublicDependencyModuleNames.AddRange(new[] { "Core", "CoreUObject", "Engine", "AudioMixer" });
    // ringdown.h, and libringdown.so with libringdown.so.1, the file that it names.
    string folder = Path.Combine(PluginDirectory, "ThirdParty");
    PrivateIncludePaths.Add(folder);
    PublicAdditionalLibraries.Add(Path.Combine(folder, "libringdown.so"));
    RuntimeDependencies.Add(Path.Combine(folder, "libringdown.so.1"));
  }
}
