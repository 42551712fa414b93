import sys, time
import numpy as np, matchset as ms
from benchmarks.crowds.scenes import SCENES, CAMERA
from benchmarks.crowds.score import Answer, score
from matchset.localization.neighbors.neighbors import Neighbors, NeighborsParameters
n=int(sys.argv[1]); seconds=float(sys.argv[2])
for name,make in SCENES.items():
    crowd=make(n,seconds,7)
    frames=list(crowd)
    f0,seen=next((f,s) for f,s in frames if any(x.visible>0.95 for x in s))
    b=max(seen,key=lambda x:x.visible*x.circle.radius)
    blue=ms.ColorModel.pick(f0.image,b.circle.x,b.circle.y)
    purple=ms.ColorModel.hsv((135,80,40),(165,255,255))
    w=Neighbors(CAMERA,ms.BallTarget(0.28,markers=((0,0,1),)),blue,purple,NeighborsParameters(max_count=20))
    ans=[];ts=[]
    for f,_ in frames:
        a=time.perf_counter(); out=w.update(f); ts.append(1e3*(time.perf_counter()-a))
        ans.append([Answer(e.identity,e.ball.shape) for e in out if isinstance(e.ball,ms.Track)])
    s=score([s for _,s in frames],ans)
    print(name,n,{k:(round(v,3) if isinstance(v,float) else v) for k,v in s._asdict().items()},'ms median %.1f p99 %.1f'%(np.median(ts),np.percentile(ts,99)))
