import sys

import taotie as tt

model, picture = sys.argv[1:]
tt.render(model, size=(640, 480)).save(picture)
