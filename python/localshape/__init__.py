"""Deformable bodies that keep their local shapes, simulated and drawn beside mass-spring models.

```python
import localshape

scene = localshape.Scene.load("scenes/fig4b.toml")
result = scene.simulate()
result["Mass-spring"].position  # frames x nodes x 3 (m)
result.frame(0.5)  # the picture at 0.5 s
```
"""

from ._core import Picture, Result, RunResult, Scene, World, __version__
from ._errors import DeviceError, Mistake, SceneError
from ._given import Recording
from ._tables import Diagnostics, Divergence

__all__ = [
    "DeviceError",
    "Diagnostics",
    "Divergence",
    "Mistake",
    "Picture",
    "Recording",
    "Result",
    "RunResult",
    "Scene",
    "SceneError",
    "World",
    "__version__",
]
