import sys, time, math
import numpy as np, matchset as ms
from scipy.optimize import linear_sum_assignment
from benchmarks.crowds.scenes import SCENES, CAMERA
from benchmarks.crowds.score import Answer, score
from matchset.localization.neighbors.ball_search import BallSearch, BallSearchParameters
from matchset.tracking.parameters import TrackerParameters
from matchset.tracking.search.voting import SearchParameters
from matchset.tracking.ball.judge import NetworkParameters
from matchset.shapes.circle import Circle
from matchset.tracking.track import Track
import os
SUP=float(os.environ.get('SUP','0.6')); BON=float(os.environ.get('BON','12'))
USED=os.environ.get('USED','1')=='1'
PAR=TrackerParameters(search=SearchParameters(whole_frame=False),network=NetworkParameters(used=USED,looks=4))

class KF:
    """state per axis [p,v,a] shared covariance; model: acceleration decays with tau"""
    def __init__(s,z,r,t,order):
        s.order=order; s.t=t; s.x=np.zeros((3,2)); s.x[0]=z; s.r=r
        s.P=np.diag([ (0.05*r+1)**2, (30*r)**2, (70*r)**2 if order==3 else 0.0]); s.ll=0.0
    def F(s,dt):
        F=np.eye(3); F[0,1]=dt
        if s.order==3: F[0,2]=dt*dt/2; F[1,2]=dt
        return F
    def Q(s,dt):
        if s.order==3:
            q=(150*s.r)**2; g=np.array([dt**3/6,dt**2/2,dt]); return q*np.outer(g,g)*1.0
        q=(40*s.r)**2; g=np.array([dt**2/2,dt,0]); return q*np.outer(g,g)
    def predict(s,t):
        dt=t-s.t; F=s.F(dt); return F@s.x, F@s.P@F.T+s.Q(dt)
    def update(s,z,t,sig):
        x,P=s.predict(t); S=P[0,0]+sig*sig; d=z-x[0]; K=P[:,0]/S
        s.ll=0.9*s.ll-0.5*float(d@d)/S-math.log(S)
        s.x=x+np.outer(K,d); s.P=P-np.outer(K,P[0]); s.t=t
class T:
    def __init__(s,i,color,c,t):
        s.id=i; s.tr=ms.Tracker(Circle,color,64,parameters=PAR); s.tr.start(c); s.new(c,t); s.hits=1; s.fresh=3; s.hidden=False; s.born=t
    def new(s,c,t):
        s.f=[KF(np.array([c.x,c.y]),c.radius,t,2),KF(np.array([c.x,c.y]),c.radius,t,3)]; s.logr=math.log(c.radius); s.seen=t; s.c=c; s.n=1
    def best(s):
        if s.n<6: return s.f[0]
        return max(s.f,key=lambda f:f.ll)
    def pred(s,t):
        x,P=s.best().predict(t); r=math.exp(s.logr)
        return Circle(float(x[0,0]),float(x[0,1]),r), P[0,0]
    def upd(s,c,t):
        if t-s.seen>0.5: s.new(c,t); return
        sig=0.5+0.03*c.radius
        for f in s.f: f.r=c.radius; f.update(np.array([c.x,c.y]),t,sig)
        s.n+=1
        s.logr+=0.3*(math.log(c.radius)-s.logr); s.seen=t; s.c=c
def far(a,b): return math.hypot(a.x-b.x,a.y-b.y)
class Multi:
    def __init__(s,color,most=20,memory=2.0):
        s.color=color; s.ts=[]; s.n=0; s.most=most; s.memory=memory
        s.search=BallSearch(color,BallSearchParameters())
    def update(s,frame):
        t=frame.time; H,W=frame.image.shape[:2]
        s.ts=[x for x in s.ts if t-x.seen<=s.memory and (x.hits>2 or t-x.seen<0.1)]
        preds={x:x.pred(t) for x in s.ts}
        sights=[]  # (circle, track, owner, support)
        order=sorted(s.ts,key=lambda x:-x.c.radius)
        for x in order:
            p,var=preds[x]
            gone=t-x.seen
            if not(-p.radius<p.x<W+p.radius and -p.radius<p.y<H+p.radius): x.hidden=True; continue
            if gone>0.6: x.hidden=True; continue
            if x.hidden or x.fresh>0: x.tr.start(p); x.fresh=max(x.fresh-1,0) if not x.hidden else 3
            try: r=x.tr.update(frame)
            except ValueError: continue
            if isinstance(r,Track): sights.append([r.shape,r,x,r.support])
        # one ball, one sighting
        sights.sort(key=lambda v:-v[3]); keep=[]
        for v in sights:
            same=next((k for k in keep if far(v[0],k[0])<0.6*max(v[0].radius,k[0].radius) and abs(math.log(v[0].radius/k[0].radius))<0.35),None)
            if same is not None: same[4].add(v[2]); continue
            keep.append([*v,{v[2]}])
        sights=keep
        for c in s.search.update(frame,[v[0] for v in sights]): sights.append([c,None,None,1.0,set()])
        # assignment
        n,m=len(s.ts),len(sights)
        C=np.full((n,m+n),1e6)
        for i,x in enumerate(s.ts):
            p,var=preds[x]; gone=t-x.seen
            for j,v in enumerate(sights):
                c=v[0]; sig=0.5+0.05*c.radius
                S=var+sig*sig; d2=far(c,p)**2/S
                dr=math.log(c.radius/p.radius); Sr=0.06**2+(0.5*gone)**2
                g=d2+dr*dr/Sr
                own=x in v[4] and not x.hidden and v[3]>SUP
                if own: C[i,j]=0.5*min(g,25)+math.log(S)+0.5*math.log(Sr)-BON
                elif d2<25 and dr*dr/Sr<25: C[i,j]=0.5*g+math.log(S)+0.5*math.log(Sr)-(0.0)
            C[i,m+i]=math.log(60.**2)+12.5
        a=dict(zip(*linear_sum_assignment(C))) if n else {}
        used=set(); out=[]
        for i,x in enumerate(s.ts):
            j=a[i]
            if j<m and C[i,j]<1e5:
                used.add(j); c,r,owner=sights[j][:3]
                if owner is not x: x.tr.start(c); x.fresh=3
                x.upd(c,t); x.hits+=1; x.hidden=False
                out.append(Answer(x.id,c))
            else:
                x.hidden=True
        for j,v in enumerate(sights):
            if j in used or v[2] is not None: continue
            c=v[0]
            if any(far(c,preds[x][0])<c.radius+preds[x][0].radius and t-x.seen<0.3 for x in preds): continue
            if len(s.ts)<s.most:
                s.ts.append(T(s.n,s.color,c,t)); s.n+=1; out.append(Answer(s.n-1,c))
        return out
if __name__=='__main__':
    n=int(sys.argv[1]); seconds=float(sys.argv[2]); seed=int(sys.argv[3]) if len(sys.argv)>3 else 7
    for name,make in SCENES.items():
        frames=list(make(n,seconds,seed))
        f0,seen=next((f,s) for f,s in frames if any(x.visible>0.95 for x in s))
        b=max(seen,key=lambda x:x.visible*x.circle.radius)
        blue=ms.ColorModel.pick(f0.image,b.circle.x,b.circle.y)
        w=Multi(blue); ans=[];ts=[]
        for f,_ in frames:
            a=time.perf_counter(); out=w.update(f); ts.append(1e3*(time.perf_counter()-a)); ans.append(out)
        sc=score([s for _,s in frames],ans)
        print(name,n,{k:(round(v,3) if isinstance(v,float) else v) for k,v in sc._asdict().items()},'ms median %.1f p99 %.1f'%(np.median(ts),np.percentile(ts,99)),flush=True)
