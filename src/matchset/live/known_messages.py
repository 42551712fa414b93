"""All messages of a page, panel by panel: `READER`."""

from matchset.live.camera.messages import MESSAGES as OF_CAMERA
from matchset.live.camera.messages import SETTINGS as OF_SETTINGS
from matchset.live.files.messages import MESSAGES as OF_FILES
from matchset.live.piloting.messages import MESSAGES as OF_PILOTING
from matchset.live.record.messages import MESSAGES as OF_RECORD
from matchset.live.sources.messages import MESSAGES as OF_SOURCES
from matchset.live.targets.messages import MESSAGES as OF_TARGETS
from matchset.live.wire.messages import Ack, PageMessageReader

READER = PageMessageReader(
    (Ack, *OF_CAMERA, *OF_FILES, *OF_PILOTING, *OF_RECORD, *OF_SETTINGS, *OF_SOURCES, *OF_TARGETS)
)
