"""All messages of a page, panel by panel: `READER`."""

from matchset.app.live.camera.messages import MESSAGES as OF_CAMERA
from matchset.app.live.camera.messages import SETTINGS as OF_SETTINGS
from matchset.app.live.files.messages import MESSAGES as OF_FILES
from matchset.app.live.piloting.messages import MESSAGES as OF_PILOTING
from matchset.app.live.record.messages import MESSAGES as OF_RECORD
from matchset.app.live.sources.messages import MESSAGES as OF_SOURCES
from matchset.app.live.targets.messages import MESSAGES as OF_TARGETS
from matchset.app.live.wire.messages import Ack, Reader

READER = Reader((Ack, *OF_CAMERA, *OF_FILES, *OF_PILOTING, *OF_RECORD, *OF_SETTINGS, *OF_SOURCES, *OF_TARGETS))
